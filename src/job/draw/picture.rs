//! The depth buffer, and the loop that fills it.

use glam::Vec3;

use super::Counts;
use crate::geometry::raster::{Clipped, Coverage, Eye, Seen};

/// The most pixels a picture may have: 16 K across and down.
pub const MOST_PIXELS: u32 = 1 << 28;

/// A depth buffer: for each pixel, row after row, one over the distance of what is nearest there, in metres
/// along the line of sight; 0 where there is nothing.
#[derive(Clone, Debug)]
pub struct Picture {
    width: u32,
    nearness: Vec<f32>,
    /// The vertices of the mesh at hand before the lens, each as far as its number says that it is of the
    /// draw call at hand.
    seen: Vec<(u32, Seen)>,
    call: u32,
}

impl Picture {
    /// An empty picture; `None` if it has no pixels or more than [`MOST_PIXELS`].
    pub fn new(width: u32, height: u32) -> Option<Self> {
        let pixels = width.checked_mul(height).filter(|pixels| (1..=MOST_PIXELS).contains(pixels))?;
        Some(Self { width, nearness: vec![0.0; pixels as usize], seen: Vec::new(), call: 0 })
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

    /// One draw call.
    pub(super) fn draw(&mut self, eye: &Eye, vertices: &[Vec3], triangles: &[[u32; 3]], counts: &mut Counts) {
        self.begin_call(vertices.len());
        let size = self.size();
        counts.draw_calls += 1;
        counts.triangles += triangles.len() as u64;
        for triangle in triangles {
            let corners = triangle.map(|vertex| self.see(eye, vertices, vertex as usize, counts));
            let [a, b, c] = corners.map(|corner| corner.outside);
            if a.shared(b, c) {
                counts.outside += 1;
                continue;
            }
            for piece in Clipped::new(eye, corners).triangles() {
                if let Some(coverage) = Coverage::new(piece, size) {
                    counts.set_up += 1;
                    self.fill(&coverage, counts);
                }
            }
        }
    }

    fn begin_call(&mut self, vertices: usize) {
        if self.seen.len() < vertices {
            self.seen.resize(vertices, (0, Seen::default()));
        }
        self.call = self.call.wrapping_add(1);
        if self.call == 0 {
            // Numbers come round: none of those before may count any more.
            self.seen.fill((0, Seen::default()));
            self.call = 1;
        }
    }

    #[inline]
    fn see(&mut self, eye: &Eye, vertices: &[Vec3], vertex: usize, counts: &mut Counts) -> Seen {
        let known = &mut self.seen[vertex];
        if known.0 != self.call {
            *known = (self.call, eye.see(vertices[vertex]));
            counts.vertices += 1;
        }
        known.1
    }

    #[inline]
    fn fill(&mut self, coverage: &Coverage, counts: &mut Counts) {
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
