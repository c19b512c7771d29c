//! Rays aimed where triangles share an edge or a corner.

use super::Intersector;
use crate::geometry::Ray;
use glam::Vec3;

/// How many of some rays from a point within a closed mesh, corners in metres, get out of it. They are aimed at points
/// of its triangles' edges and at its corners: what a ray test loses is lost there.
///
/// `rays` are numbers, each of which stands for one and the same ray, so that a long run can be dealt out.
pub fn leaks(
    tracer: &impl Intersector,
    triangles: &[[Vec3; 3]],
    within: Vec3,
    rays: std::ops::Range<u64>,
) -> u64 {
    rays.filter(|&number| tracer.closest(&aimed_at_edge(triangles, within, number)).is_none()).count() as u64
}

/// The ray of a number: every fourth at a corner, the others at a point of an edge.
fn aimed_at_edge(triangles: &[[Vec3; 3]], within: Vec3, number: u64) -> Ray {
    let random = mixed(number);
    let triangle = &triangles[(random % triangles.len() as u64) as usize];
    let corner = (random >> 40) as usize % 3;
    let (a, b) = (triangle[corner], triangle[(corner + 1) % 3]);
    let share = if number.is_multiple_of(4) { 0.0 } else { (mixed(random) >> 40) as f32 / (1 << 24) as f32 };
    Ray::new(within, a + (b - a) * share - within)
}

/// A number without order: the finalizer of splitmix64 (Steele, Lea and Flood 2014).
fn mixed(number: u64) -> u64 {
    let mut z = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}
