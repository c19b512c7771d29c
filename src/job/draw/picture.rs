//! The depth buffer, and the loop that fills it.

use glam::Vec3;

use super::Counts;
use crate::geometry::raster::{Clipped, Coverage, Eye, Spot};

/// The most pixels a picture may have: 16 K across and down.
pub const MOST_PIXELS: u32 = 1 << 28;

/// A depth buffer: for each pixel, row after row, one over the distance of what is nearest there, in metres
/// along the line of sight; 0 where there is nothing.
#[derive(Clone, Debug)]
pub struct Picture {
    width: u32,
    nearness: Vec<f32>,
    /// The vertices of the draw call at hand before the lens.
    spots: Vec<Spot>,
}

impl Picture {
    /// An empty picture; `None` if it has no pixels or more than [`MOST_PIXELS`].
    pub fn new(width: u32, height: u32) -> Option<Self> {
        let pixels = width.checked_mul(height).filter(|pixels| (1..=MOST_PIXELS).contains(pixels))?;
        Some(Self { width, nearness: vec![0.0; pixels as usize], spots: Vec::new() })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.nearness.len() as u32 / self.width]
    }

    /// The pixels, row after row from the upper left corner.
    pub fn nearness(&self) -> &[f32] {
        &self.nearness
    }

    /// How many pixels something was drawn on.
    pub fn covered(&self) -> usize {
        self.nearness.iter().filter(|nearness| **nearness > 0.0).count()
    }

    /// One number for the whole picture: FNV-1a over the bits of its pixels. Equal pictures have equal ones;
    /// two that differ have the same in one case of 2^64.
    pub fn fingerprint(&self) -> u64 {
        self.nearness.iter().fold(0xcbf2_9ce4_8422_2325, |hash, nearness| {
            (hash ^ u64::from(nearness.to_bits())).wrapping_mul(0x0100_0000_01b3)
        })
    }

    pub(super) fn clear(&mut self) {
        self.nearness.fill(0.0);
    }

    /// One draw call: triangles by index into `vertices`, all of which are used.
    pub(super) fn draw(&mut self, eye: &Eye, vertices: &[Vec3], triangles: &[[u32; 3]], counts: &mut Counts) {
        let size = self.size();
        counts.draw_calls += 1;
        counts.vertices += vertices.len() as u64;
        counts.triangles += triangles.len() as u64;
        let mut spots = std::mem::take(&mut self.spots);
        spots.clear();
        spots.extend(vertices.iter().map(|vertex| eye.spot(*vertex)));
        for triangle in triangles {
            let [a, b, c] = triangle.map(|vertex| &spots[vertex as usize]);
            if a.outside.shared(b.outside, c.outside) {
                counts.outside += 1;
            } else if a.is_inside && b.is_inside && c.is_inside {
                self.fill(Coverage::new([a.corner, b.corner, c.corner], size), counts);
            } else {
                let corners = triangle.map(|vertex| eye.see(vertices[vertex as usize]));
                for piece in Clipped::new(eye, corners).triangles() {
                    self.fill(Coverage::new(piece, size), counts);
                }
            }
        }
        self.spots = spots;
    }

    #[inline]
    fn fill(&mut self, coverage: Option<Coverage>, counts: &mut Counts) {
        let Some(coverage) = coverage else { return };
        counts.set_up += 1;
        let (pixels, width) = (&mut self.nearness, self.width);
        coverage.fill(|column, row, nearness| {
            let pixel = &mut pixels[(row * width + column) as usize];
            counts.pixel_tests += 1;
            if nearness > *pixel {
                *pixel = nearness;
                counts.pixels_passed += 1;
            }
        });
    }
}
