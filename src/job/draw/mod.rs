//! Drawing what culling left: a depth buffer filled by software, to count what a frame costs behind the
//! culling (Bubenicek 2020, sec. 4; BU-11) without a graphics card.
//!
//! A leaf found visible is one draw call. Each vertex it uses is transformed once a call, as a card with a
//! cache behind its index buffer would; each triangle that is not wholly outside the view is cut, set up and
//! filled. The picture is the same whatever leaves the triangles are drawn in and in whatever order, as
//! long as none that can be seen is missing: that is the oracle of every culled frame.

mod buffers;
mod picture;

use glam::Affine3A;

use crate::geometry::Camera;
use crate::geometry::raster::Eye;
use crate::scene::Scene;
use crate::structure::PlacedLeaves;
use buffers::Buffers;
pub use picture::{MOST_PIXELS, Picture};

/// What drawing a frame took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Leaves drawn, each with one call.
    pub draw_calls: u64,
    /// Vertices brought before the lens.
    pub vertices: u64,
    /// Triangles of the leaves drawn.
    pub triangles: u64,
    /// Those of them that lie wholly outside the view: what finer leaves would have spared.
    pub outside: u64,
    /// Triangles set up, those that a clip plane cut counted in their pieces; without those that have no
    /// area on the grid of pixels.
    pub set_up: u64,
    /// Pixels covered, each time a triangle covers one: tests against the depth buffer.
    pub pixel_tests: u64,
    /// Pixel tests that found the triangle nearer than what was there.
    pub pixels_passed: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.draw_calls += other.draw_calls;
        self.vertices += other.vertices;
        self.triangles += other.triangles;
        self.outside += other.outside;
        self.set_up += other.set_up;
        self.pixel_tests += other.pixel_tests;
        self.pixels_passed += other.pixels_passed;
    }
}

/// A scene's leaves, ready to be drawn.
pub struct Drawing<'a> {
    leaves: &'a PlacedLeaves,
    worlds: Vec<Affine3A>,
    /// What each mesh's leaves draw from.
    buffers: Vec<Buffers>,
}

impl<'a> Drawing<'a> {
    /// A valid scene, and the leaves made of it.
    pub fn new(scene: &Scene, leaves: &'a PlacedLeaves) -> Self {
        let buffers = scene.meshes.iter().zip(&leaves.splits);
        let buffers = buffers.map(|(mesh, split)| Buffers::new(&mesh.positions, split)).collect();
        Self { leaves, worlds: scene.world_transforms(), buffers }
    }

    /// Clears a picture and draws some leaves, by index into [`PlacedLeaves::leaves`].
    ///
    /// # Panics
    /// If a leaf is not one of this drawing's.
    pub fn draw(
        &self,
        camera: &Camera,
        visible: impl IntoIterator<Item = u32>,
        picture: &mut Picture,
    ) -> Counts {
        picture.clear();
        let mut counts = Counts::default();
        let mut eye: Option<(u32, Eye)> = None;
        for leaf in visible {
            let placed = self.leaves.leaves[leaf as usize];
            // Leaves of one node mostly come one after the other.
            let eye = match eye {
                Some((node, eye)) if node == placed.node => eye,
                _ => {
                    let new = Eye::new(camera, picture.size(), &self.worlds[placed.node as usize]);
                    eye.insert((placed.node, new)).1
                }
            };
            let (vertices, triangles) = self.buffers[placed.mesh as usize].of_leaf(placed.leaf);
            picture.draw(&eye, vertices, triangles, &mut counts);
        }
        counts
    }

    /// Draws all leaves: culling off.
    pub fn draw_all(&self, camera: &Camera, picture: &mut Picture) -> Counts {
        self.draw(camera, 0..self.leaves.leaves.len() as u32, picture)
    }
}

#[cfg(test)]
mod tests;
