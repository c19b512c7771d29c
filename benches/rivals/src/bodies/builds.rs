//! Trees built on one thread: millions of triangles a second.

use super::contenders::trimesh;
use super::meshes::Mesh;
use crate::clock::{self, Run, median, ratios};
use apportion::geometry::{Aabb, Obb, Overlap};
use std::hint::black_box;
use std::rc::Rc;

/// Prints how fast ours and parry's are built; the target is a million triangles a second.
pub(super) fn time(meshes: &[Rc<Mesh>]) {
    for mesh in meshes {
        let mut contenders = [
            ours::<Obb>("Obb", mesh, 2),
            ours::<Obb>("Obb", mesh, 4),
            ours::<Aabb>("Aabb", mesh, 2),
            ours::<Aabb>("Aabb", mesh, 4),
            parry(mesh),
        ];
        let mut runs: Vec<Run<'_>> = contenders.iter_mut().map(|(_, run)| Box::new(run) as Run<'_>).collect();
        let times = clock::rounds(&mut runs);
        drop(runs);
        println!("\ntrees over {}, {} triangles, target 1 M triangles/s", mesh.name, mesh.len());
        println!("{:46} M triangles/s, by the median; time as a multiple of the first's", "");
        for ((name, _), own) in contenders.iter().zip(&times) {
            let (middle, ratio) = (median(own.iter().copied()), median(ratios(own, &times[0])));
            println!("{name:46} {:8.2} {ratio:8.2}x", mesh.len() as f64 * 1e3 / middle);
        }
    }
}

fn ours<'a, V: Overlap>(name: &str, mesh: &'a Mesh, leaf: usize) -> (String, Run<'a>) {
    let run = move || {
        black_box(mesh.tree::<V>(leaf));
    };
    (format!("{name}, leaf {leaf}"), Box::new(run))
}

/// Its mesh with its tree: copies of corners and triangles included, as ours makes them too.
fn parry(mesh: &Mesh) -> (String, Run<'_>) {
    let run = move || {
        black_box(trimesh(mesh));
    };
    ("parry3d TriMesh::new (Aabb, binned, leaf 1)".to_owned(), Box::new(run))
}
