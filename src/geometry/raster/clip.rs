//! A triangle cut to what can be drawn of it.

use super::{Corner, Eye, Seen};

/// A triangle has three corners, and each of the six planes adds at most one.
const MOST: usize = 9;

/// What is left of a triangle: a convex polygon, as a fan of triangles.
#[derive(Clone, Copy, Debug)]
pub struct Clipped {
    corners: [Seen; MOST],
    count: usize,
}

impl Clipped {
    /// Cuts a triangle at the near and far plane and, where it reaches very far out of the picture, at a
    /// guard band. Two triangles that share an edge are cut at the same points of it. A corner that is NaN
    /// leaves nothing.
    pub fn new(eye: &Eye, corners: [Seen; 3]) -> Self {
        let mut clipped = Self { corners: [Seen::default(); MOST], count: 3 };
        clipped.corners[..3].copy_from_slice(&corners);
        let is_drawn = |corner: &Seen| eye.margins(corner).iter().all(|margin| *margin >= 0.0);
        if !corners.iter().all(is_drawn) {
            for plane in 0..6 {
                clipped.cut(|corner| eye.margins(corner)[plane]);
            }
        }
        clipped
    }

    /// Keeps what has a margin of 0 or more.
    fn cut(&mut self, margin: impl Fn(&Seen) -> f64) {
        let (old, count) = (self.corners, self.count);
        self.count = 0;
        for (at, from) in old[..count].iter().enumerate() {
            let to = &old[(at + 1) % count];
            let [here, there] = [margin(from), margin(to)];
            if here >= 0.0 {
                self.add(*from);
                if there < 0.0 {
                    self.add(between(from, to, here, there));
                }
            } else if there >= 0.0 && here < 0.0 {
                // From the inner end outward in both cases, so that the triangle on the other side of the
                // edge, which walks it the other way, finds the very same point.
                self.add(between(to, from, there, here));
            }
        }
    }

    fn add(&mut self, corner: Seen) {
        self.corners[self.count] = corner;
        self.count += 1;
    }

    /// The triangles, on the grid of pixels.
    pub fn triangles(&self) -> impl Iterator<Item = [Corner; 3]> {
        (2..self.count).map(|last| [0, last - 1, last].map(|corner| Corner::of(&self.corners[corner])))
    }
}

/// The point at which the margin is 0 between one that has it and one that has not.
fn between(inner: &Seen, outer: &Seen, has: f64, lacks: f64) -> Seen {
    let share = has / (has - lacks);
    let mix = |inner: f64, outer: f64| inner + (outer - inner) * share;
    Seen {
        x: mix(inner.x, outer.x),
        y: mix(inner.y, outer.y),
        depth: mix(inner.depth, outer.depth),
        outside: super::Outside::default(),
    }
}
