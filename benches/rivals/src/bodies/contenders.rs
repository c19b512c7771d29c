//! Who is asked: ours by both kinds of boxes and both kinds of queries, then what parry offers.
//!
//! Parry has two ways for two meshes. `query::intersection_test` descends the second mesh's tree once for each
//! triangle of the first that lies in the second's box. `Bvh::leaf_pairs` descends both at once and leaves the test of
//! two boxes to the caller; it is given the boxes of the second moved by the shift, which a body that was also turned
//! could not have so cheaply, and parry's test of two triangles (GJK).

use super::meshes::Mesh;
use super::{Question, Rigid};
use apportion::geometry::{Aabb, Obb, Overlap};
use apportion::job::collide::{Query, contacts};
use glam_ours::{DVec3, Vec3};
use parry3d::math::{Pose, Vector};
use parry3d::partitioning::BvhNode;
use parry3d::query::details::intersection_test_support_map_support_map as triangles_touch;
use parry3d::query::intersection_test;
use parry3d::shape::TriMesh;
use std::hint::black_box;

/// One way to ask.
pub(super) struct Contender<'a> {
    pub(super) name: String,
    pub(super) run: Box<dyn FnMut() + 'a>,
    /// Tests of boxes and of triangles in a query, where they are counted.
    pub(super) tests: Option<(u64, u64)>,
}

/// What two bodies that are pushed into each other have.
pub(super) struct Pairs {
    /// Pairs of triangles that touch, as we tell.
    pub(super) ours: usize,
    /// Of these, those that parry does not tell; and those that it alone tells.
    pub(super) missed: usize,
    pub(super) added: usize,
}

pub(super) fn all(question: &Question) -> Vec<Contender<'_>> {
    let mut contenders = Vec::new();
    for first in [true, false] {
        contenders.push(ours::<Obb>("Obb", question, first));
    }
    for first in [true, false] {
        contenders.push(ours::<Aabb>("Aabb", question, first));
    }
    let [a, b] = parry(question);
    let shift = pose(question.apart);
    let pairs = move || {
        black_box(touching(&a, &b, &shift).next());
    };
    let [a, b] = parry(question);
    let test = move || {
        black_box(intersection_test(&Pose::identity(), &a, &shift, &b).expect("parry tests meshes"));
    };
    let named = |name: &str, run| Contender { name: name.to_owned(), run, tests: None };
    contenders.push(named("parry3d Bvh::leaf_pairs, first", Box::new(pairs)));
    contenders.push(named("parry3d query::intersection_test", Box::new(test)));
    contenders
}

fn ours<'a, V: Overlap>(name: &str, question: &Question, first: bool) -> Contender<'a> {
    let ([a, b], motion) = (question.trees::<V>(), question.motion());
    let query = Query { first, reach: 0.0 };
    let found = contacts(&a, &b, &motion, query);
    let run = move || {
        black_box(contacts(&a, &b, &motion, query));
    };
    let name = format!("{name}, {}", if first { "first" } else { "all" });
    Contender { name, run: Box::new(run), tests: Some((found.box_tests, found.triangle_tests)) }
}

/// Holds all answers against each other.
///
/// # Panics
/// If one differs; of pairs, told exactly by us and in single precision by parry, up to one in twenty may.
pub(super) fn check(question: &Question) -> Pairs {
    let ([oriented, other], aligned) = (question.trees::<Obb>(), question.trees::<Aabb>());
    let [a, b] = parry(question);
    let ask = |at: DVec3| {
        let motion = Rigid::shift(at);
        let all = contacts(&oriented, &other, &motion, Query::default()).pairs;
        assert_eq!(contacts(&aligned[0], &aligned[1], &motion, Query::default()).pairs, all);
        let query = Query { first: true, reach: 0.0 };
        let one = contacts(&oriented, &other, &motion, query).pairs;
        assert_eq!(one.is_empty(), all.is_empty());
        assert_eq!(contacts(&aligned[0], &aligned[1], &motion, query).pairs.is_empty(), all.is_empty());
        let told = intersection_test(&Pose::identity(), &a, &pose(at), &b).expect("parry tests meshes");
        assert_eq!(told.intersecting, !all.is_empty(), "parry's intersection_test");
        let mut told: Vec<(u32, u32)> = touching(&a, &b, &pose(at)).collect();
        assert_eq!(told.is_empty(), all.is_empty(), "parry's leaf_pairs");
        told.sort_unstable();
        (all, told)
    };
    assert!(ask(question.apart).0.is_empty(), "{}: they touch", question.name);
    let (all, told) = ask(question.pushed);
    assert!(!all.is_empty(), "{}: they do not touch when pushed", question.name);
    let missing = |of: &[(u32, u32)], from: &[(u32, u32)]| {
        of.iter().filter(|pair| from.binary_search(pair).is_err()).count()
    };
    let (missed, added) = (missing(&all, &told), missing(&told, &all));
    assert!((missed + added) * 20 <= all.len(), "of {} pairs {missed} missed, {added} added", all.len());
    Pairs { ours: all.len(), missed, added }
}

/// Parry's pairs of triangles that touch, one after the other.
fn touching<'a>(a: &'a TriMesh, b: &'a TriMesh, shift: &Pose) -> impl Iterator<Item = (u32, u32)> + use<'a> {
    let (by, shift) = (shift.translation, *shift);
    let near = move |a: &BvhNode, b: &BvhNode| {
        a.mins().cmple(b.maxs() + by).all() && (b.mins() + by).cmple(a.maxs()).all()
    };
    let touch = move |&(i, j): &(u32, u32)| triangles_touch(&shift, &a.triangle(i), &b.triangle(j));
    a.bvh().leaf_pairs(b.bvh(), near).filter(touch)
}

fn parry(question: &Question) -> [TriMesh; 2] {
    [&question.a, &question.b].map(|mesh| trimesh(mesh))
}

/// Parry's mesh, with its tree.
pub(super) fn trimesh(mesh: &Mesh) -> TriMesh {
    TriMesh::new(vectors(&mesh.positions), mesh.triangles.clone()).expect("it has triangles")
}

fn vectors(points: &[Vec3]) -> Vec<Vector> {
    points.iter().map(|point| Vector::from_array(point.to_array())).collect()
}

fn pose(shift: DVec3) -> Pose {
    Pose::from_translation(Vector::from_array(shift.as_vec3().to_array()))
}
