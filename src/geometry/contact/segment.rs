//! A segment against a triangle, exactly, however flat either is.

use super::{Triangle, edges, side};
use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

/// Whether a segment, perhaps a point, has a point in common with a triangle, perhaps flat.
pub(super) fn segment_meets(segment: [DVec3; 2], triangle: &Triangle) -> bool {
    let Some(view) = View::upon(triangle) else {
        // A flat triangle is its edges.
        return edges(triangle).any(|edge| segments_meet(segment, edge));
    };
    let [p, q] = segment;
    let (from, to) = (side(triangle, p), side(triangle, q));
    if (from > 0.0 && to > 0.0) || (from < 0.0 && to < 0.0) {
        return false;
    }
    if from == 0.0 && to == 0.0 {
        return view.holds(triangle, p) || view.holds(triangle, q) || {
            edges(triangle).any(|edge| view.segments_meet(segment, edge))
        };
    }
    // The segment crosses the plane: its line passes all edges on the same side, or touches some.
    let [a, b, c] = *triangle;
    let signs = [[a, b], [b, c], [c, a]].map(|[u, v]| side(&[p, q, u], v));
    signs.iter().all(|sign| *sign >= 0.0) || signs.iter().all(|sign| *sign <= 0.0)
}

/// Whether two segments in space have a point in common.
fn segments_meet(s: [DVec3; 2], t: [DVec3; 2]) -> bool {
    if side(&[s[0], s[1], t[0]], t[1]) != 0.0 {
        return false;
    }
    let any = [s[0], s[1], t[0], t[1]];
    let triples = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]].map(|triple| triple.map(|i: usize| any[i]));
    match triples.iter().find_map(View::upon) {
        Some(view) => view.segments_meet(s, t),
        // All on one line: in the order of their coordinates, read as a word is.
        None => {
            let [s, t] = [s, t].map(|[from, to]| if before(from, to) { [from, to] } else { [to, from] });
            !before(s[1], t[0]) && !before(t[1], s[0])
        }
    }
}

fn before(a: DVec3, b: DVec3) -> bool {
    a.to_array() < b.to_array()
}

/// A look along an axis in which a plane is not seen edge-on: what lies in the plane is told apart there.
#[derive(Clone, Copy)]
struct View {
    along: usize,
}

impl View {
    /// A look at the plane of a triangle; `None` if the triangle is flat.
    fn upon(triangle: &Triangle) -> Option<Self> {
        let views = (0..3).map(|along| View { along });
        let [a, b, c] = *triangle;
        views.into_iter().find(|view| view.turn(a, b, c) != 0.0)
    }

    fn flat(self, point: DVec3) -> DVec2 {
        DVec2::new(point[(self.along + 1) % 3], point[(self.along + 2) % 3])
    }

    /// Whether `c` lies left or right of the line from `a` to `b`: the exact sign.
    fn turn(self, a: DVec3, b: DVec3, c: DVec3) -> f64 {
        let coord = |point: DVec3| {
            let DVec2 { x, y } = self.flat(point);
            Coord { x, y }
        };
        orient2d(coord(a), coord(b), coord(c))
    }

    /// Whether a point of a triangle's plane lies in it.
    fn holds(self, triangle: &Triangle, point: DVec3) -> bool {
        let [a, b, c] = *triangle;
        let signs = [[a, b], [b, c], [c, a]].map(|[u, v]| self.turn(u, v, point));
        signs.iter().all(|sign| *sign >= 0.0) || signs.iter().all(|sign| *sign <= 0.0)
    }

    /// Whether two segments in the plane have a point in common.
    fn segments_meet(self, s: [DVec3; 2], t: [DVec3; 2]) -> bool {
        let parted = |[a, b]: [DVec3; 2], [c, d]: [DVec3; 2]| {
            let (c, d) = (self.turn(a, b, c), self.turn(a, b, d));
            (c > 0.0 && d > 0.0) || (c < 0.0 && d < 0.0)
        };
        // On one line neither parts the other, and what decides is the boxes around them.
        let boxes_meet = || {
            let ends = |[a, b]: [DVec3; 2]| {
                let (a, b) = (self.flat(a), self.flat(b));
                (a.min(b), a.max(b))
            };
            let ((s_low, s_high), (t_low, t_high)) = (ends(s), ends(t));
            s_low.cmple(t_high).all() && t_low.cmple(s_high).all()
        };
        !parted(s, t) && !parted(t, s) && boxes_meet()
    }
}
