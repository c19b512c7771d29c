//! k-DOPs: slabs along a few fixed directions (Paper I sec. 5, future work).

use glam::{DVec3, Vec3};

use super::{Placed, Volume};
use crate::geometry::culling::ROUNDING;

/// All directions there are: the axes, the edges' and the corners' of a cube.
const AXES: [Vec3; 3] = Vec3::AXES;
const EDGES: [Vec3; 6] = [
    Vec3::new(1.0, 1.0, 0.0),
    Vec3::new(1.0, -1.0, 0.0),
    Vec3::new(1.0, 0.0, 1.0),
    Vec3::new(1.0, 0.0, -1.0),
    Vec3::new(0.0, 1.0, 1.0),
    Vec3::new(0.0, 1.0, -1.0),
];
const CORNERS: [Vec3; 4] = [
    Vec3::new(1.0, 1.0, 1.0),
    Vec3::new(1.0, 1.0, -1.0),
    Vec3::new(1.0, -1.0, 1.0),
    Vec3::new(1.0, -1.0, -1.0),
];

/// A convex body between two planes a direction: `D` of 7 makes a 14-DOP (axes and corners of a cube), 9 an
/// 18-DOP (axes and edges), 13 a 26-DOP (all). Lengths are in metres times the direction's own length.
///
/// Where along a normal it ends is a linear program. Here a normal is written, once a plane and frame, as a
/// sum of the three directions around it with weights that are not negative; the same sum of their ends
/// bounds the body, as tightly as three slabs can, for the price of a box: three products a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KDop<const D: usize> {
    /// The least products, then the greatest.
    pub(super) ends: [[f32; D]; 2],
}

/// The direction of that number.
fn direction<const D: usize>(number: usize) -> Vec3 {
    match (number, D) {
        (0..3, _) => AXES[number],
        (_, 7) => CORNERS[number - 3],
        (3..9, _) => EDGES[number - 3],
        _ => CORNERS[number - 9],
    }
}

impl<const D: usize> KDop<D> {
    /// The one that holds nothing.
    pub const EMPTY: Self = Self { ends: [[f32::INFINITY; D], [f32::NEG_INFINITY; D]] };

    /// The smallest around some points; empty if there are none.
    pub fn of_points(points: &[Vec3]) -> Self {
        const { assert!(D == 7 || D == 9 || D == 13) };
        let directions: [DVec3; D] = std::array::from_fn(|i| direction::<D>(i).as_dvec3());
        let (mut low, mut high, mut odd) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D], false);
        for point in points {
            odd |= !point.is_finite();
            for (i, direction) in directions.iter().enumerate() {
                let product = point.as_dvec3().dot(*direction);
                (low[i], high[i]) = (low[i].min(product), high[i].max(product));
            }
        }
        if odd {
            return Self { ends: [[f32::NAN; D]; 2] };
        }
        if points.is_empty() {
            return Self::EMPTY;
        }
        // Rounded outward.
        let down = |x: f64| if f64::from(x as f32) > x { (x as f32).next_down() } else { x as f32 };
        let up = |x: f64| if f64::from(x as f32) < x { (x as f32).next_up() } else { x as f32 };
        Self { ends: [low.map(down), high.map(up)] }
    }

    /// The directions, each with its least and its greatest product.
    pub fn slabs(&self) -> impl Iterator<Item = (Vec3, f32, f32)> {
        (0..D).map(|i| (direction::<D>(i), self.ends[0][i], self.ends[1][i]))
    }

    fn corner(&self, pick: [usize; 3]) -> Vec3 {
        Vec3::new(self.ends[pick[0]][0], self.ends[pick[1]][1], self.ends[pick[2]][2])
    }
}

/// A normal as a sum of three directions.
#[derive(Clone, Copy, Debug)]
pub struct Sum {
    direction: [u8; 3],
    /// Which ends the n-vertex lies at.
    end: [u8; 3],
    /// Weights with the directions' signs.
    weight: [f32; 3],
}

/// A k-DOP relative to the eye.
#[derive(Clone, Copy, Debug)]
pub struct PlacedKDop<'a, const D: usize> {
    volume: &'a KDop<D>,
    eye: &'a [f32; D],
    slack: f32,
}

impl<const D: usize> Volume for KDop<D> {
    type Field = Sum;
    type Eye = [f32; D];
    type Placed<'a> = PlacedKDop<'a, D>;
    const ROUND: bool = false;

    fn field(normal: Vec3) -> Sum {
        // In the part of space where x >= y >= z >= 0, which all others mirror.
        let size = normal.abs().to_array();
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| size[*b].total_cmp(&size[*a]));
        let [x, y, z] = order.map(|axis| size[axis]);
        let parts: [([u8; 3], f32); 3] = match D {
            7 => [([1, 0, 0], x - z), ([0, 1, 0], y - z), ([1, 1, 1], z)],
            13 => [([1, 0, 0], x - y), ([1, 1, 0], y - z), ([1, 1, 1], z)],
            _ if x >= y + z => [([1, 0, 0], x - y - z), ([1, 1, 0], y), ([1, 0, 1], z)],
            _ => [
                ([1, 1, 0], (x + y - z) * 0.5),
                ([1, 0, 1], (x + z - y) * 0.5),
                ([0, 1, 1], (y + z - x) * 0.5),
            ],
        };
        let mut sum = Sum { direction: [0; 3], end: [0; 3], weight: [0.0; 3] };
        for (i, (steps, weight)) in parts.into_iter().enumerate() {
            let mut towards = Vec3::ZERO;
            for (axis, step) in order.into_iter().zip(steps) {
                towards[axis] = if step == 0 { 0.0 } else { 1f32.copysign(normal[axis]) };
            }
            let same = |number: &usize| {
                let known = direction::<D>(*number);
                known == towards || known == -towards
            };
            // A normal that is no number finds its weights, and so all products, no numbers either.
            let number = (0..D).find(same).unwrap_or(0);
            let along = direction::<D>(number) == towards;
            sum.direction[i] = number as u8;
            sum.end[i] = u8::from(!along);
            sum.weight[i] = if along { weight } else { -weight };
        }
        sum
    }

    fn eye(eye: Vec3) -> [f32; D] {
        std::array::from_fn(|i| direction::<D>(i).as_dvec3().dot(eye.as_dvec3()) as f32)
    }

    #[inline]
    fn is_empty(&self) -> bool {
        self.ends[0].iter().zip(&self.ends[1]).any(|(low, high)| low > high)
    }

    #[inline]
    fn is_nan(&self) -> bool {
        self.ends[0][0].is_nan()
    }

    #[inline]
    fn placed<'a>(&'a self, eye: &'a [f32; D]) -> PlacedKDop<'a, D> {
        let from = Vec3::new(eye[0], eye[1], eye[2]);
        let size = ((self.corner([0; 3]) - from).abs() + (self.corner([1; 3]) - from).abs()).element_sum();
        // No product along a direction exceeds the 1-norm of the farthest corner, and no sum of weights 1.74;
        // the eye's own products were rounded as well.
        let slack = (2.0 * size + from.abs().element_sum()) * (2.0 * ROUNDING) + f32::MIN_POSITIVE;
        PlacedKDop { volume: self, eye, slack }
    }

    #[inline]
    fn centre(&self) -> Vec3 {
        self.corner([0; 3]) * 0.5 + self.corner([1; 3]) * 0.5
    }

    #[inline]
    fn radius(&self) -> f32 {
        // That of the box around it: never less than its own.
        (self.corner([1; 3]) * 0.5 - self.corner([0; 3]) * 0.5).length()
    }

    #[inline]
    fn corners_from(&self, origin: Vec3) -> [Vec3; 8] {
        std::array::from_fn(|i| self.corner([i & 1, i >> 1 & 1, i >> 2 & 1]) - origin)
    }
}

impl<const D: usize> PlacedKDop<'_, D> {
    #[inline]
    fn product(&self, sum: &Sum, far: u8) -> f32 {
        let term = |i: usize| {
            let direction = usize::from(sum.direction[i]);
            let end = self.volume.ends[usize::from(sum.end[i] ^ far)][direction];
            sum.weight[i] * (end - self.eye[direction])
        };
        term(0) + term(1) + term(2)
    }
}

impl<const D: usize> Placed for PlacedKDop<'_, D> {
    type Field = Sum;

    #[inline]
    fn nearest(&self, _: Vec3, sum: &Sum) -> f32 {
        self.product(sum, 0)
    }

    #[inline]
    fn farthest(&self, _: Vec3, sum: &Sum) -> f32 {
        self.product(sum, 1)
    }

    #[inline]
    fn slack(&self) -> f32 {
        self.slack
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sums_give_their_normal<const D: usize>() {
        for x in -4..=4 {
            for y in -4..=4 {
                for z in -4..=4 {
                    let normal = Vec3::new(x as f32, y as f32, z as f32 + 0.25).normalize();
                    let sum = KDop::<D>::field(normal);
                    let mut back = Vec3::ZERO;
                    for i in 0..3 {
                        let along = direction::<D>(usize::from(sum.direction[i]));
                        back += along * sum.weight[i];
                        // The end goes with the sign: the n-vertex lies at the least end of what adds.
                        assert!(sum.weight[i] == 0.0 || (sum.weight[i] < 0.0) == (sum.end[i] == 1));
                    }
                    assert!((back - normal).length() < 1e-6, "{normal} {sum:?}");
                }
            }
        }
    }

    #[test]
    fn a_normal_is_the_sum_of_its_directions() {
        sums_give_their_normal::<7>();
        sums_give_their_normal::<9>();
        sums_give_their_normal::<13>();
    }

    #[test]
    fn bounds_its_points_and_is_tighter_than_a_box() {
        let points: Vec<Vec3> = (0..200)
            .map(|i| {
                let (a, b) = (i as f32 * 0.37, i as f32 * 0.11);
                Vec3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin())
            })
            .collect();
        let (volume, bounds) =
            (KDop::<13>::of_points(&points), crate::geometry::Aabb::of_points(points.clone()));
        let eye = Vec3::new(0.5, -3.0, 2.0);
        let (at, from) = (<KDop<13> as Volume>::eye(eye), eye);
        let placed = volume.placed(&at);
        let normal = Vec3::new(0.5, 0.62, -0.6).normalize();
        let least = points.iter().map(|p| normal.dot(*p - eye)).fold(f32::MAX, f32::min);
        let found = placed.nearest(normal, &KDop::<13>::field(normal));
        let boxed = bounds.placed(&from).nearest(normal, &crate::geometry::Aabb::field(normal));
        assert!(found <= least + 1e-5 && found > boxed + 0.3, "{boxed} {found} {least}");
        assert!(KDop::<7>::of_points(&[]).is_empty() && KDop::<9>::of_points(&[Vec3::NAN]).is_nan());
    }
}
