//! Which pixels a triangle covers, and how deep it is there.

use super::Seen;

/// Steps to a pixel that corners are snapped to.
const STEPS: i64 = 256;
/// How far from the picture's upper left corner a corner may be, in pixels: products of two differences
/// then stay far below 2^63.
pub(super) const GUARD: u32 = 1 << 20;

/// A corner of a triangle on the grid of pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corner {
    /// To the right and downward from the upper left corner of the picture, in 1/256 of a pixel.
    pub place: [i32; 2],
    /// One over the depth in metres, which unlike the depth is even across the picture.
    pub nearness: f64,
}

impl Corner {
    /// Where a point before the lens falls; it must be clipped.
    #[inline]
    pub(super) fn of(seen: &Seen) -> Self {
        let nearness = 1.0 / seen.depth;
        // Rounded by cutting a positive number short, half up: quicker than to the nearest. The cast holds what
        // lies beyond the guard band, which the last corner cut may by a rounding.
        let (steps, shift) = (STEPS as f64, 2 * STEPS as i32 * GUARD as i32);
        let snap = |at: f64| ((at * nearness * steps + f64::from(shift) + 0.5) as i32).saturating_sub(shift);
        Self { place: [snap(seen.x), snap(seen.y)], nearness }
    }
}

/// A triangle ready to be filled: its set-up.
#[derive(Clone, Copy, Debug)]
pub struct Coverage {
    /// Wound so that its area is positive.
    corners: [Corner; 3],
    /// Twice the area, in steps squared.
    area: i64,
    /// The first and, not included, last pixel it can cover, across and down.
    columns: [i64; 2],
    rows: [i64; 2],
}

impl Coverage {
    /// Sets a triangle up for a picture of `width` x `height` pixels; `None` if it has no area.
    /// Either winding will do.
    #[inline]
    pub fn new(mut corners: [Corner; 3], [width, height]: [u32; 2]) -> Option<Self> {
        let [a, b, c] = corners.map(|corner| corner.place.map(i64::from));
        let mut area = edge(a, b, c);
        if area < 0 {
            corners.swap(1, 2);
            area = -area;
        }
        // The pixels whose centres lie within the corners.
        let range = |axis: usize, size: u32| {
            let [a, b, c] = [a, b, c].map(|place| place[axis]);
            let low = (a.min(b).min(c) + STEPS / 2 - 1).div_euclid(STEPS);
            let high = (a.max(b).max(c) - STEPS / 2).div_euclid(STEPS) + 1;
            [low.max(0), high.min(i64::from(size))]
        };
        (area > 0).then(|| Self { corners, area, columns: range(0, width), rows: range(1, height) })
    }

    /// Visits each pixel covered, with its nearness there (one over metres): column, row, nearness.
    #[inline]
    pub fn fill(&self, mut visit: impl FnMut(u32, u32, f32)) {
        // Most triangles of a fine mesh lie between the centres of pixels.
        if self.columns[0] >= self.columns[1] || self.rows[0] >= self.rows[1] {
            return;
        }
        let [a, b, c] = self.corners.map(|corner| corner.place.map(i64::from));
        let edges = [(b, c), (c, a), (a, b)];
        let share = self.corners.map(|corner| corner.nearness / self.area as f64);
        let first = [self.columns[0] * STEPS + STEPS / 2, self.rows[0] * STEPS + STEPS / 2];
        let mut row_start = edges.map(|(from, to)| edge(from, to, first));
        // An edge's own pixels count if it is a top or a left one.
        let least = edges.map(|(from, to)| i64::from(!is_top_left(from, to)));
        let right = edges.map(|(from, to)| (from[1] - to[1]) * STEPS);
        let down = edges.map(|(from, to)| (to[0] - from[0]) * STEPS);
        for row in self.rows[0]..self.rows[1] {
            let mut at = row_start;
            for column in self.columns[0]..self.columns[1] {
                if at[0] >= least[0] && at[1] >= least[1] && at[2] >= least[2] {
                    let nearness =
                        at[0] as f64 * share[0] + at[1] as f64 * share[1] + at[2] as f64 * share[2];
                    visit(column as u32, row as u32, nearness as f32);
                }
                for (at, right) in at.iter_mut().zip(right) {
                    *at += right;
                }
            }
            for (start, down) in row_start.iter_mut().zip(down) {
                *start += down;
            }
        }
    }
}

/// Twice the signed area of a triangle; positive if `at` lies to the right of the way from `from` to `to`,
/// where y points down.
fn edge(from: [i64; 2], to: [i64; 2], at: [i64; 2]) -> i64 {
    (to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0])
}

/// Whether an edge is a top edge (level, with the triangle below) or a left one (going up), for a triangle
/// of positive area and y pointing down.
fn is_top_left(from: [i64; 2], to: [i64; 2]) -> bool {
    to[1] < from[1] || (to[1] == from[1] && to[0] > from[0])
}
