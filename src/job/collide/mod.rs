//! Collision detection by two hierarchies (Paper II sec. 5): which triangles of two bodies touch, or come nearer than
//! some distance.
//!
//! It starts with the two roots. Of a pair of boxes that overlap the larger is descended, or the one that is no leaf
//! (where the paper says the smaller is tested against the children of the larger, P2-16); two leaves are tested
//! triangle by triangle, exactly. A task is a pair of boxes, so every tree scheme can share a query out.
//!
//! ```
//! use apportion::geometry::{Obb, Rigid};
//! use apportion::job::collide::{Query, contacts};
//! use apportion::structure::VolumeTree;
//! use glam::{DVec3, Vec3};
//! let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
//! let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let body = VolumeTree::<Obb>::over_triangles(&corners, &faces, 2)?;
//! let aside = |x: f64| Rigid::shift(DVec3::X * x);
//! assert!(contacts(&body, &body, &aside(1.1), Query::default()).pairs.is_empty());
//! assert_eq!(contacts(&body, &body, &aside(1.0), Query::default()).pairs.len(), 9, "a corner on a corner");
//! # Ok::<(), apportion::structure::VolumeTreeError>(())
//! ```

mod costs;
mod pair;
mod shared;
mod work;

use crate::geometry::{Overlap, Rigid, Unit};
use crate::machine::{Machine, Threads, Word};
use crate::scheme::tree::TreeWork;
use crate::structure::VolumeTree;
pub use costs::{Costs, Times};
pub use pair::{Pair, TreeView};
pub use shared::SharedTree;
use std::sync::atomic::Ordering;
pub use work::{BatchWork, Found, PairWork};

/// What is asked about two bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Query {
    /// Whether any one contact will do: the query ends when one is found.
    pub first: bool,
    /// Contacts are triangles that come nearer than this, in metres; 0, and what is below, for those that touch.
    pub reach: f64,
}

/// One processor's, or everyone's, contacts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contacts {
    /// The triangles, or scene nodes, that touch: of the first body and of the second, by number, in order.
    pub pairs: Vec<(u32, u32)>,
    /// Overlap tests of boxes.
    pub box_tests: u64,
    /// Pairs of triangles tested.
    pub triangle_tests: u64,
    /// Pairs of leaves that overlapped though none of their triangles touch.
    pub false_overlaps: u64,
}

impl Contacts {
    /// Puts together what the processors found.
    pub fn gather<'a>(parts: impl IntoIterator<Item = &'a Found>) -> Self {
        let mut all = Self::default();
        for part in parts {
            all.pairs.extend(&part.pairs);
            all.box_tests += part.box_tests;
            all.triangle_tests += part.triangle_tests;
            all.false_overlaps += part.false_overlaps;
        }
        all.pairs.sort_unstable();
        all
    }

    /// The same of a body's own contacts, the lower number of each pair first.
    pub fn gather_own<'a>(parts: impl IntoIterator<Item = &'a Found>) -> Self {
        let mut all = Self::gather(parts);
        for (a, b) in &mut all.pairs {
            (*a, *b) = ((*a).min(*b), (*a).max(*b));
        }
        all.pairs.sort_unstable();
        all
    }
}

/// The contacts of two bodies, the second moved, on this thread.
///
/// Nothing is missed for numbers that say nothing: where the motion has one that is NaN or infinite, nobody knows where
/// the second body is, and with a reach that is NaN, what is near; every pair is then a contact. That is as many as the
/// bodies' triangles multiplied: ask [`Rigid::is_finite`] first if a motion may be such.
pub fn contacts<V: Overlap>(a: &VolumeTree<V>, b: &VolumeTree<V>, motion: &Rigid, query: Query) -> Contacts {
    let pair = Pair::new(a, b, motion, query.reach, Unit::best());
    Contacts::gather([&on_this_thread(&pair, query)])
}

/// The pairs of a body's own triangles that touch, the lower number first. Triangles that share a corner, by its
/// number, are neighbours and not asked about.
pub fn own_contacts<V: Overlap>(body: &VolumeTree<V>, query: Query) -> Contacts {
    let pair = Pair::of_one(body, query.reach, Unit::best());
    Contacts::gather_own([&on_this_thread(&pair, query)])
}

fn on_this_thread<V: Overlap>(pair: &Pair<'_, V>, query: Query) -> Found {
    type Native = <Threads as Machine>::Word;
    let stop = Native::new(0);
    let work = BatchWork::<Native, V>::new(pair, query.first.then_some(&stop));
    let (mut found, mut stack) = (work.found(), Vec::new());
    if let Some(root) = work.root() {
        let cpu = crate::machine::threads::Thread::outside(0, 1);
        work.descend(root, &mut found, &cpu, &mut stack);
    }
    found
}

/// Whether any processor has found a contact, where one is enough.
///
/// Nothing else is read on its account (what was found is handed over when the run ends), so no order is needed: the
/// load and the store are each other's partners. A processor that sees it late tests a few pairs more.
#[inline]
fn is_over<W: Word>(stop: Option<&W>) -> bool {
    stop.is_some_and(|stop| stop.load(Ordering::Relaxed) != 0)
}

#[cfg(test)]
mod tests;
