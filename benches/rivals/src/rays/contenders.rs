//! Who takes rays through.

use apportion::geometry::hit::{Fast, Watertight};
use apportion::geometry::{Aabb, Ray};
use apportion::structure::bvh::{BinaryBvh, BinaryNode, Intersector, WideBvh};
use glam_ours::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::RayHit;
use obvhs::triangle::Triangle;
use std::time::Duration;

/// One way to do it. A run tells how many rays hit.
pub(super) struct Contender<'a> {
    pub(super) name: &'static str,
    pub(super) run: Box<dyn FnMut() -> usize + 'a>,
}

/// What they go through.
pub(super) struct Built {
    binary: Bvh2,
    compressed: CwBvh,
    /// obvhs' triangles, in the order of the leaves of either, so that it need not look them up.
    in_binary: Vec<Triangle>,
    in_compressed: Vec<Triangle>,
    fast: WideBvh<Fast>,
    pub(super) watertight: WideBvh<Watertight>,
}

impl Built {
    /// Everything over some triangles, by obvhs' medium builder.
    pub(super) fn over(triangles: &[[Vec3; 3]]) -> Self {
        let theirs: Vec<Triangle> = triangles
            .iter()
            .map(|&[a, b, c]| Triangle { v0: a.into(), v1: b.into(), v2: c.into() })
            .collect();
        let mut time = Duration::ZERO;
        let binary = build_bvh2_from_tris(&theirs, BvhBuildParams::medium_build(), &mut time);
        let compressed = build_cwbvh_from_tris(&theirs, BvhBuildParams::medium_build(), &mut time);
        let pick = |order: &[u32]| order.iter().map(|item| theirs[*item as usize]).collect();
        let ours = as_ours(&binary);
        Self {
            in_binary: pick(&binary.primitive_indices),
            in_compressed: pick(&compressed.primitive_indices),
            fast: WideBvh::new(&ours, triangles),
            watertight: WideBvh::new(&ours, triangles),
            binary,
            compressed,
        }
    }
}

/// The same hierarchy with children after their parents.
fn as_ours(binary: &Bvh2) -> BinaryBvh {
    let node = |at: u32| {
        let node = &binary.nodes[at as usize];
        let bounds = Aabb { min: node.aabb().min.into(), max: node.aabb().max.into() };
        BinaryNode { bounds, first: node.first_index, count: node.prim_count }
    };
    let mut nodes = vec![node(0)];
    let mut next = 0;
    while next < nodes.len() {
        if !nodes[next].is_leaf() {
            let first = nodes[next].first;
            nodes[next].first = nodes.len() as u32;
            nodes.extend([node(first), node(first + 1)]);
        }
        next += 1;
    }
    BinaryBvh { nodes, order: binary.primitive_indices.clone() }
}

pub(super) fn all<'a>(built: &'a Built, rays: &'a [Ray]) -> Vec<Contender<'a>> {
    let as_theirs = |ray: &Ray| obvhs::ray::Ray::new_inf(Vec3A::from(ray.origin), Vec3A::from(ray.direction));
    let theirs: Vec<obvhs::ray::Ray> = rays.iter().map(as_theirs).collect();
    let same = theirs.clone();
    let binary = move || {
        let hits = theirs.iter().filter(|ray| {
            let test = |ray: &obvhs::ray::Ray, at: usize| built.in_binary[at].intersect(ray);
            built.binary.ray_traverse(**ray, &mut RayHit::none(), test)
        });
        hits.count()
    };
    let compressed = move || {
        let hits = same.iter().filter(|ray| {
            let test = |ray: &obvhs::ray::Ray, at: usize| built.in_compressed[at].intersect(ray);
            built.compressed.ray_traverse(**ray, &mut RayHit::none(), test)
        });
        hits.count()
    };
    vec![
        Contender { name: "obvhs Bvh2, medium", run: Box::new(binary) },
        Contender { name: "obvhs CwBvh, medium", run: Box::new(compressed) },
        Contender { name: "wide, fast test", run: one_by_one(&built.fast, rays) },
        Contender { name: "wide, watertight test", run: one_by_one(&built.watertight, rays) },
        Contender { name: "wide, fast test, packets", run: in_packets(&built.fast, rays) },
        Contender { name: "wide, watertight test, packets", run: in_packets(&built.watertight, rays) },
    ]
}

fn one_by_one<'a>(tracer: &'a impl Intersector, rays: &'a [Ray]) -> Box<dyn FnMut() -> usize + 'a> {
    Box::new(|| rays.iter().filter(|ray| tracer.closest(ray).is_some()).count())
}

fn in_packets<'a>(tracer: &'a impl Intersector, rays: &'a [Ray]) -> Box<dyn FnMut() -> usize + 'a> {
    let mut hits = vec![None; rays.len()];
    Box::new(move || {
        tracer.closest_coherent(rays, &mut hits);
        hits.iter().flatten().count()
    })
}
