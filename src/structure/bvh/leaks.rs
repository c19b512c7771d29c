//! Rays aimed where triangles share an edge or a corner.

use super::Intersector;
use crate::geometry::Ray;
use glam::Vec3;
use std::ops::Range;

/// Rays that are aimed at the same edge.
const TOGETHER: usize = 16;

/// How many of some rays from a point within a closed mesh, corners in metres, get out of it. They are aimed at points
/// of its triangles' edges and at its corners: what a ray test loses is lost there.
///
/// `rays` are numbers, each of which stands for one and the same ray, so that a long run can be dealt out.
pub fn leaks(tracer: &impl Intersector, triangles: &[[Vec3; 3]], within: Vec3, rays: Range<u64>) -> u64 {
    rays.filter(|&number| tracer.closest(&at_edge(triangles, within, number, number)).is_none()).count()
        as u64
}

/// As [`leaks`], but the rays are asked about together, 16 at a time: those of one of `packets` are aimed at points of
/// one edge and at its corners.
pub fn leaks_together(
    tracer: &impl Intersector,
    triangles: &[[Vec3; 3]],
    within: Vec3,
    packets: Range<u64>,
) -> u64 {
    let lost = |packet: u64| {
        let first = packet * TOGETHER as u64;
        let rays: [Ray; TOGETHER] =
            std::array::from_fn(|i| at_edge(triangles, within, packet, first + i as u64));
        let mut hits = [None; TOGETHER];
        tracer.closest_coherent(&rays, &mut hits);
        hits.iter().filter(|hit| hit.is_none()).count() as u64
    };
    packets.map(lost).sum()
}

/// The ray of a number, aimed at the edge of a number: every fourth at its first corner, the others at a point of it.
fn at_edge(triangles: &[[Vec3; 3]], within: Vec3, edge: u64, number: u64) -> Ray {
    let (edge, random) = (mixed(edge), mixed(number));
    let triangle = &triangles[(edge % triangles.len() as u64) as usize];
    let corner = (edge >> 40) as usize % 3;
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
