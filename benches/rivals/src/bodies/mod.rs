//! Two bodies that lie close to each other and do not touch, asked whether they do: apportion's trees and parry's, one
//! after the other in each round. What does not touch is the hard case: no query may end early, so one that looks for
//! any contact does the work of one that looks for all.
//!
//! Before anything is timed each contender's answer is held against ours, where the bodies lie apart and where they
//! are pushed into each other. Targets are those of the collision study.

mod boxes_alone;
mod builds;
mod contenders;
mod meshes;
mod threads;

use crate::clock::{self, Run, least, median, ratios};
use apportion::geometry::{Aabb, Obb, Overlap, Rigid};
use apportion::structure::VolumeTree;
use contenders::Pairs;
use glam_ours::DVec3;
use meshes::Mesh;
use std::path::Path;
use std::rc::Rc;

/// Most triangles in a leaf.
const LEAF: usize = 2;

/// Two bodies and where the second is put.
struct Question {
    name: String,
    a: Rc<Mesh>,
    b: Rc<Mesh>,
    /// Where they lie close and do not touch; and where they are pushed into each other. In metres.
    apart: DVec3,
    pushed: DVec3,
    /// What a query is meant to take on one thread, in microseconds.
    target: f64,
}

pub(crate) fn study(file: Option<&Path>) {
    let body = Rc::new(file.map_or_else(meshes::bumpy_ball, meshes::of_file));
    let questions = questions(&body);
    for question in &questions {
        ask(question);
    }
    builds::time(&[body, questions[2].a.clone()]);
    for question in &questions[2..] {
        threads::time(question);
    }
}

/// Two of the body with a gap of 0.1 % and of 2 % of its longest side, and shells in shells.
fn questions(body: &Rc<Mesh>) -> Vec<Question> {
    let side = meshes::longest_side(body);
    let beside = |share: f64, target: f64| {
        let apart = DVec3::X * meshes::beside(body, share * side);
        let pushed = apart - DVec3::X * (share + 0.01) * side;
        let name = format!("two of {}, a gap of {} % of its longest side", body.name, share * 100.0);
        Question { name, a: body.clone(), b: body.clone(), apart, pushed, target }
    };
    let shell = Rc::new(meshes::shell("shell"));
    let radius = meshes::longest_side(&shell) / 2.0;
    let within = |inner: &str, gap: f64, target: f64| Question {
        name: format!("{inner} within shell"),
        a: shell.clone(),
        b: Rc::new(meshes::shell(inner)),
        apart: DVec3::ZERO,
        pushed: DVec3::X * (2.0 * gap * radius),
        target,
    };
    vec![
        beside(0.001, 50.0),
        beside(0.02, 6.0),
        within("shell-1", 0.01, 1400.0),
        within("shell-5", 0.05, 250.0),
    ]
}

fn ask(question: &Question) {
    let pairs = contenders::check(question);
    let mut contenders = contenders::all(question);
    let mut runs: Vec<Run<'_>> = contenders.iter_mut().map(|one| Box::new(&mut one.run) as Run<'_>).collect();
    let times = clock::rounds(&mut runs);
    drop(runs);
    println!(
        "\n{}: {} and {} triangles, target {} us",
        question.name,
        question.a.len(),
        question.b.len(),
        question.target
    );
    let Pairs { ours, missed, added } = pairs;
    println!("pushed into each other: {ours} pairs touch; parry misses {missed} and adds {added}");
    println!("{:46} median, least us; times the first; box tests, triangle tests; ns a box test", "");
    for (one, own) in contenders.iter().zip(&times) {
        let (middle, ratio) = (median(own.iter().copied()), median(ratios(own, &times[0])));
        print!("{:46} {:9.1} {:9.1} {ratio:8.2}x", one.name, middle / 1e3, least(own) / 1e3);
        match &one.tests {
            Some((boxes, triangles)) => {
                println!(" {boxes:8} {triangles:6} {:6.1}", middle / (*boxes).max(1) as f64);
            }
            None => println!(),
        }
    }
    boxes_alone::time::<Obb>("Obb", question, Some(25.0));
    boxes_alone::time::<Aabb>("Aabb", question, None);
}

impl Question {
    /// The trees of both bodies, leaves of [`LEAF`].
    fn trees<V: Overlap>(&self) -> [VolumeTree<V>; 2] {
        [&self.a, &self.b].map(|mesh| mesh.tree(LEAF))
    }

    fn motion(&self) -> Rigid {
        Rigid::shift(self.apart)
    }
}
