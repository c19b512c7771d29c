//! Triangles of a polygon, also of a concave one: ears are cut off (Meisters 1975), and every sign is exact
//! (Shewchuk 1997, by crate `robust`). A polygon of `n` corners always gives `n - 2` triangles, as published counts of
//! scenes are counted: a corner that lies on a straight edge is kept, and so are corners that coincide.

use std::collections::VecDeque;

use glam::{DVec3, Vec3};
use robust::{Coord, orient2d};

/// The most corners of a polygon that is not convex: the time they take grows with their square.
pub(super) const MOST_CONCAVE: usize = 1 << 14;

/// What has become of a polygon.
pub(super) struct Outline {
    /// Corners by number, in the polygon's own sense of turning.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Whether it crosses itself: its triangles are some of many that could be meant.
    pub(super) is_crossed: bool,
}

/// Cuts a polygon of at least three corners up, as seen along its normal; none if it is not convex and has too many.
pub(super) fn triangulate(corners: &[Vec3]) -> Option<Outline> {
    let fan = || (1..corners.len() as u32 - 1).map(|corner| [0, corner, corner + 1]).collect();
    if corners.len() == 3 {
        return Some(Outline { triangles: fan(), is_crossed: false });
    }
    let flat = flatten(corners);
    let count = flat.len();
    let next = |corner: usize| if corner + 1 == count { 0 } else { corner + 1 };
    let turns_left = |at: usize| turn([flat[at], flat[next(at)], flat[next(next(at))]]) > 0.0;
    let seen_from_first = |at: usize| turn([flat[0], flat[at], flat[at + 1]]) > 0.0;
    if (0..count).all(turns_left) && (1..count - 1).all(seen_from_first) {
        return Some(Outline { triangles: fan(), is_crossed: false });
    }
    (count <= MOST_CONCAVE).then(|| Ring::new(&flat).cut())
}

/// The corners as seen along the axis that is nearest to the normal, turning left; nothing is rounded.
fn flatten(corners: &[Vec3]) -> Vec<Coord<f64>> {
    let origin = corners[0].as_dvec3();
    let ring = corners.iter().zip(corners.iter().cycle().skip(1));
    // Newell's normal, about a corner: far from the world's origin the products would drown it.
    let normal =
        ring.fold(DVec3::ZERO, |sum, (a, b)| sum + (a.as_dvec3() - origin).cross(b.as_dvec3() - origin));
    let (least, most) = corners.iter().fold((corners[0], corners[0]), |(a, b), c| (a.min(*c), b.max(*c)));
    // One that crosses itself may have no normal: then along the axis on which it is thinnest.
    let is_level = normal == DVec3::ZERO;
    let axis = if is_level { (most - least).min_position() } else { normal.abs().max_position() };
    let (right, up) = ((axis + 1) % 3, (axis + 2) % 3);
    let is_seen_from_behind = normal[axis] < 0.0;
    let place = |corner: &Vec3| {
        let (x, y) = (f64::from(corner[right]), f64::from(corner[up]));
        Coord { x, y: if is_seen_from_behind { -y } else { y } }
    };
    corners.iter().map(place).collect()
}

/// Above 0 if the corners turn left, 0 if they lie on a line.
fn turn([a, b, c]: [Coord<f64>; 3]) -> f64 {
    orient2d(a, b, c)
}

/// What is left of a polygon.
struct Ring<'a> {
    flat: &'a [Coord<f64>],
    next: Vec<usize>,
    before: Vec<usize>,
    is_gone: Vec<bool>,
    /// Corners that turn right or not at all: only such can lie in the way of an ear.
    dull: Vec<usize>,
    is_dull: Vec<bool>,
    /// Corners that can be cut off. What is cut off elsewhere makes none of another, as the polygon only shrinks.
    ears: VecDeque<usize>,
    is_ear: Vec<bool>,
    /// How many corners may still be looked at whether they are ears.
    looks: usize,
}

impl<'a> Ring<'a> {
    fn new(flat: &'a [Coord<f64>]) -> Self {
        let count = flat.len();
        let mut ring = Self {
            flat,
            next: (1..count).chain([0]).collect(),
            before: std::iter::once(count - 1).chain(0..count - 1).collect(),
            is_gone: vec![false; count],
            dull: Vec::new(),
            is_dull: vec![false; count],
            ears: VecDeque::new(),
            is_ear: vec![false; count],
            looks: 16 * count,
        };
        (0..count).for_each(|corner| ring.feel(corner));
        (0..count).for_each(|corner| ring.look_at(corner));
        ring
    }

    fn cut(mut self) -> Outline {
        let mut triangles = Vec::with_capacity(self.flat.len() - 2);
        let (mut at, mut is_crossed) = (0, false);
        while triangles.len() + 3 < self.flat.len() {
            let mut ear = self.ear();
            if ear.is_none() && !is_crossed {
                // What lay on the edge of an ear may be gone, or all that is left runs to and fro on a line.
                self.left(at).for_each(|corner| self.look_at(corner));
                let straight = |ring: &Self| ring.left(at).find(|corner| ring.turn(*corner) == 0.0);
                ear = self.ear().or_else(|| straight(&self));
            }
            is_crossed |= ear.is_none();
            let ear = ear.or_else(|| self.left(at).find(|corner| !self.is_dull[*corner])).unwrap_or(at);
            triangles.push(self.about(ear).map(|corner| corner as u32));
            at = self.remove(ear);
        }
        is_crossed |= self.turn(at) < 0.0;
        triangles.push(self.about(at).map(|corner| corner as u32));
        Outline { triangles, is_crossed }
    }

    /// The corners that are left, from one of them on.
    fn left(&self, from: usize) -> std::vec::IntoIter<usize> {
        let after = |corner: &usize| Some(self.next[*corner]).filter(|next| *next != from);
        std::iter::successors(Some(from), after).collect::<Vec<_>>().into_iter()
    }

    /// The ear that has waited longest.
    fn ear(&mut self) -> Option<usize> {
        while let Some(corner) = self.ears.pop_front() {
            if self.is_ear[corner] && !self.is_gone[corner] {
                return Some(corner);
            }
        }
        None
    }

    /// A corner between its neighbours.
    fn about(&self, corner: usize) -> [usize; 3] {
        [self.before[corner], corner, self.next[corner]]
    }

    fn turn(&self, corner: usize) -> f64 {
        turn(self.about(corner).map(|corner| self.flat[corner]))
    }

    /// Takes a corner out, and returns the one after it.
    fn remove(&mut self, corner: usize) -> usize {
        let [before, _, next] = self.about(corner);
        (self.next[before], self.before[next]) = (next, before);
        (self.is_gone[corner], self.is_dull[corner]) = (true, false);
        self.feel(before);
        self.feel(next);
        let is_dull = &self.is_dull;
        self.dull.retain(|corner| is_dull[*corner]);
        self.look_at(before);
        self.look_at(next);
        next
    }

    fn feel(&mut self, corner: usize) {
        let is_dull = self.turn(corner) <= 0.0;
        if is_dull && !self.is_dull[corner] {
            self.dull.push(corner);
        }
        self.is_dull[corner] = is_dull;
    }

    /// Finds out whether a corner is an ear: whether nothing lies in the triangle of it and its neighbours. What lies
    /// on one of the three is where the outline touches itself: it is in nobody's way, what follows on it would be.
    ///
    /// A corner that the outline comes to and goes from on one line, or that is one with a neighbour, goes first:
    /// once it is gone no ear can be taken for one on the wrong side of that line.
    fn look_at(&mut self, corner: usize) {
        let was = std::mem::replace(&mut self.is_ear[corner], false);
        let [a, b, c] = self.about(corner).map(|corner| self.flat[corner]);
        if turn([a, b, c]) == 0.0 && (a.x - b.x) * (c.x - b.x) + (a.y - b.y) * (c.y - b.y) >= 0.0 {
            self.is_ear[corner] = true;
            self.ears.push_front(corner);
            return;
        }
        if self.is_dull[corner] || self.looks == 0 {
            return;
        }
        self.looks -= 1;
        let within = |p: f64, a: f64, b: f64, c: f64| (a.min(b).min(c)..=a.max(b).max(c)).contains(&p);
        let is_in_the_way = |other: &usize| {
            let p = self.flat[*other];
            // Their box first: most are outside of that.
            let is_near = within(p.x, a.x, b.x, c.x) && within(p.y, a.y, b.y, c.y);
            let is_within = || turn([a, b, p]) >= 0.0 && turn([b, c, p]) >= 0.0 && turn([c, a, p]) >= 0.0;
            is_near && p != a && p != b && p != c && is_within()
        };
        self.is_ear[corner] = !self.dull.iter().any(is_in_the_way);
        if self.is_ear[corner] && !was {
            self.ears.push_back(corner);
        }
    }
}

#[cfg(test)]
#[path = "polygon_tests.rs"]
mod tests;
