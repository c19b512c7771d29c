//! Oriented boxes (Paper I sec. 4).

mod extremes;

use glam::{DMat3, DVec3, Vec3};

use super::{Placed, Volume};
use crate::geometry::{Aabb, culling::ROUNDING};

/// Of how many points at most the covariance is worth its time.
const SAMPLE: usize = 512;

/// A box with axes of its own, in metres; empty if an extent is negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obb {
    pub(super) centre: Vec3,
    pub(super) axes: [Vec3; 3],
    /// Half of its extent on each axis.
    pub(super) half: Vec3,
}

impl Obb {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { centre: Vec3::ZERO, axes: Vec3::AXES, half: Vec3::NEG_ONE };

    /// The smallest box with these axes around some points; empty if there are none. The axes are made unit
    /// vectors; they need not be at right angles, but the box is small only if they are. `None` if an axis
    /// is zero or not a number, or if they lie in a plane.
    pub fn with_axes(axes: [Vec3; 3], points: &[Vec3]) -> Option<Self> {
        Self::spanned(axes, points.iter().map(|point| point.as_dvec3()))
    }

    /// The same around points in double precision.
    pub(super) fn spanned(axes: [Vec3; 3], points: impl Iterator<Item = DVec3>) -> Option<Self> {
        let axes = axes.map(|axis| axis.as_dvec3().normalize_or_zero().as_vec3());
        let exact = DMat3::from_cols(axes[0].as_dvec3(), axes[1].as_dvec3(), axes[2].as_dvec3());
        if exact.determinant().abs() < 1e-3 {
            return None;
        }
        // A point's coordinates are those of the axes as they were rounded, so the box holds it exactly.
        let coordinates = exact.inverse();
        // By comparisons, which are one instruction where `min` is several: what is no number is seen by the sum.
        let (mut low, mut high, mut sum) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3], DVec3::ZERO);
        for point in points {
            let at = coordinates * point;
            sum += at;
            for (i, at) in at.to_array().into_iter().enumerate() {
                low[i] = if at < low[i] { at } else { low[i] };
                high[i] = if at > high[i] { at } else { high[i] };
            }
        }
        let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
        if !sum.is_finite() {
            return Some(Self { centre: Vec3::NAN, axes, half: Vec3::ZERO });
        }
        if low.x > high.x {
            // There were none.
            return Some(Self { axes, ..Self::EMPTY });
        }
        let centre = (exact * ((low + high) / 2.0)).as_vec3();
        // From the centre as it was rounded, and rounded up.
        let at = coordinates * centre.as_dvec3();
        let slop = 1e-14 * high.abs().max(low.abs()).element_sum() + f64::from(f32::MIN_POSITIVE);
        let half = ((high - at).max(at - low) + slop).as_vec3();
        Some(Self { centre, axes, half: Vec3::from_array(half.to_array().map(f32::next_up)) })
    }

    /// A small box around some points: the one with the least surface among those with the axes of the
    /// world, the axes of the points' covariance, and others offered. Empty if there are none.
    pub fn of_points(points: &[Vec3], offered: &[[Vec3; 3]]) -> Self {
        let spread = [principal_axes(points.iter().copied())];
        let frames = [Vec3::AXES].into_iter().chain(spread).chain(offered.iter().copied());
        let boxes = frames.filter_map(|axes| Self::with_axes(axes, points));
        boxes.min_by(|a, b| a.surface().total_cmp(&b.surface())).unwrap_or(Self::EMPTY)
    }

    /// A tight box around some points, for many points at a time: of the axes of the world, those of the points'
    /// covariance, and those that fourteen extreme points suggest, the ones with the
    /// least surface, turned about the thinnest side as far as that helps. Its axes are at right angles but for
    /// rounding. Empty if there are none.
    pub fn tight(points: &[Vec3]) -> Self {
        // Triangles side by side share corners, and everything below is asked of each.
        let mut different = [Vec3::ZERO; extremes::LEAF];
        let points = if points.len() <= extremes::LEAF { once_each(points, &mut different) } else { points };
        // Many points are sampled: their covariance is but one offer.
        let sample = points.iter().step_by(points.len() / SAMPLE + 1).copied();
        extremes::axes(points, || principal_axes(sample))
            .into_iter()
            .filter_map(at_right_angles)
            .find_map(|axes| Self::with_axes(axes, points))
            .unwrap_or(Self::EMPTY)
    }

    /// Its corners, in metres, from what it is made of; [`Volume::corners`] are rounded.
    pub(super) fn fine_corners(&self) -> [DVec3; 8] {
        let half = self.half.as_dvec3();
        let arms = [0, 1, 2].map(|axis| self.axes[axis].as_dvec3() * half[axis]);
        std::array::from_fn(|i| {
            let arm = |axis: usize| if i >> axis & 1 == 0 { -arms[axis] } else { arms[axis] };
            self.centre.as_dvec3() + arm(0) + arm(1) + arm(2)
        })
    }

    /// Whether all its numbers are finite.
    pub(super) fn is_finite(&self) -> bool {
        self.centre.is_finite() && self.half.is_finite() && self.axes.iter().all(|axis| axis.is_finite())
    }

    /// Unit vectors along its edges.
    pub fn axes(&self) -> [Vec3; 3] {
        self.axes
    }

    /// Half of its extent on each axis, in metres.
    pub fn half(&self) -> Vec3 {
        self.half
    }

    /// Its surface, in square metres; 0 if it is empty.
    pub fn surface(&self) -> f32 {
        let half = self.half.max(Vec3::ZERO);
        8.0 * (half.x * half.y + half.y * half.z + half.z * half.x)
    }
}

/// The points, each once, in their order; `room` is for as many as there are.
fn once_each<'a>(points: &[Vec3], room: &'a mut [Vec3]) -> &'a [Vec3] {
    let mut len = 0;
    for point in points {
        // What is not a number is no other's equal and stays.
        if !room[..len].contains(point) {
            room[len] = *point;
            len += 1;
        }
    }
    &room[..len]
}

/// Axes like these at right angles, as near as f32 can write them; `None` if they are too far from it. What was made
/// of points so close that their products underflow leans, or has no length to speak of.
fn at_right_angles(axes: [Vec3; 3]) -> Option<[Vec3; 3]> {
    let [u, v, _] = axes.map(|axis| axis.as_dvec3());
    let u = u.try_normalize()?;
    let v = v.reject_from_normalized(u);
    let v = (v.length() > 0.5).then(|| v.normalize())?;
    Some([u, v, u.cross(v)].map(DVec3::as_vec3))
}

/// An axis-aligned box taken for an oriented one, as Paper I did (sec. 4).
impl From<Aabb> for Obb {
    fn from(bounds: Aabb) -> Self {
        if bounds.is_empty() && !bounds.is_nan() {
            return Self::EMPTY;
        }
        Self::with_axes(Vec3::AXES, &[bounds.min, bounds.max]).unwrap_or(Self::EMPTY)
    }
}

/// The axes of some points' covariance: the eigenvectors of a symmetric matrix, by Jacobi's rotations. Those
/// of the world if there are no points to speak of.
fn principal_axes(points: impl ExactSizeIterator<Item = Vec3> + Clone) -> [Vec3; 3] {
    let count = points.len().max(1) as f64;
    let mean = points.clone().map(Vec3::as_dvec3).sum::<DVec3>() / count;
    // On the diagonal, and off it.
    let (mut squares, mut products) = (DVec3::ZERO, DVec3::ZERO);
    for point in points {
        let at = point.as_dvec3() - mean;
        squares += at * at;
        products += at * DVec3::new(at.y, at.z, at.x);
    }
    let (DVec3 { x: xx, y: yy, z: zz }, DVec3 { x: xy, y: yz, z: zx }) = (squares / count, products / count);
    let mut matrix = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    if matrix.iter().flatten().any(|cell| !cell.is_finite()) {
        return Vec3::AXES;
    }
    let mut axes = DVec3::AXES;
    // Eight sweeps are more than three coordinates ever need.
    for _ in 0..8 {
        if [(0, 1), (0, 2), (1, 2)].iter().all(|&(p, q): &(usize, usize)| is_zero(&matrix, p, q)) {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if is_zero(&matrix, p, q) {
                continue;
            }
            let theta = (matrix[q][q] - matrix[p][p]) / (2.0 * matrix[p][q]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for row in &mut matrix {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            let (row_p, row_q) = (matrix[p], matrix[q]);
            matrix[p] = std::array::from_fn(|k| c * row_p[k] - s * row_q[k]);
            matrix[q] = std::array::from_fn(|k| s * row_p[k] + c * row_q[k]);
            (axes[p], axes[q]) = (axes[p] * c - axes[q] * s, axes[p] * s + axes[q] * c);
        }
    }
    axes.map(DVec3::as_vec3)
}

/// Whether a matrix' cell is nothing beside the diagonal: the axes are f32, and the turns keep them at right angles
/// whatever is left.
fn is_zero(matrix: &[[f64; 3]; 3], p: usize, q: usize) -> bool {
    matrix[p][q].abs() <= 1e-8 * (matrix[p][p] + matrix[q][q])
}

/// An oriented box relative to the eye.
#[derive(Clone, Copy, Debug)]
pub struct PlacedObb {
    centre: Vec3,
    axes: [Vec3; 3],
    half: Vec3,
    slack: f32,
}

impl Volume for Obb {
    /// The signs of the normal's projections depend on the box, so nothing can be worked out before it.
    type Field = ();
    type Eye = Vec3;
    type Placed<'a> = PlacedObb;
    const ROUND: bool = false;

    #[inline]
    fn field(_: Vec3) {}

    #[inline]
    fn eye(eye: Vec3) -> Vec3 {
        eye
    }

    #[inline]
    fn is_empty(&self) -> bool {
        self.half.cmplt(Vec3::ZERO).any()
    }

    #[inline]
    fn is_nan(&self) -> bool {
        self.centre.is_nan() || self.half.is_nan()
    }

    #[inline]
    fn placed(&self, eye: &Vec3) -> PlacedObb {
        let centre = self.centre - *eye;
        // The 1-norm of a unit vector is below 1.74, and the projections go through some more sums than a
        // corner does: twice the bound, taken of twice the extents.
        let size = centre.abs().element_sum() + 2.0 * self.half.element_sum();
        let slack = size * (2.0 * ROUNDING) + f32::MIN_POSITIVE;
        PlacedObb { centre, axes: self.axes, half: self.half, slack }
    }

    #[inline]
    fn centre(&self) -> Vec3 {
        self.centre
    }

    #[inline]
    fn radius(&self) -> f32 {
        // The length of a diagonal, were the axes at right angles exactly.
        self.half.length() * (1.0 + 1e-3)
    }

    #[inline]
    fn corners_from(&self, origin: Vec3) -> [Vec3; 8] {
        let centre = self.centre - origin;
        let arms = [0, 1, 2].map(|axis| self.axes[axis] * self.half[axis]);
        std::array::from_fn(|i| {
            let arm = |axis: usize| if i >> axis & 1 == 0 { -arms[axis] } else { arms[axis] };
            centre + arm(0) + arm(1) + arm(2)
        })
    }
}

impl PlacedObb {
    /// Half of the extent along a normal: its projections on the axes, nine products, and their signs
    /// (Paper I sec. 4).
    #[inline]
    fn reach(&self, normal: Vec3) -> f32 {
        let [a, b, c] = self.axes.map(|axis| normal.dot(axis).abs());
        Vec3::new(a, b, c).dot(self.half)
    }
}

impl Placed for PlacedObb {
    type Field = ();

    #[inline]
    fn nearest(&self, normal: Vec3, (): &()) -> f32 {
        normal.dot(self.centre) - self.reach(normal)
    }

    #[inline]
    fn farthest(&self, normal: Vec3, (): &()) -> f32 {
        normal.dot(self.centre) + self.reach(normal)
    }

    #[inline]
    fn slack(&self) -> f32 {
        self.slack
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Mat3, Quat};

    #[test]
    fn a_turned_box_is_found_again() {
        let turn = Mat3::from_quat(Quat::from_axis_angle(Vec3::new(1.0, 2.0, -0.5).normalize(), 0.7));
        let corners = Aabb { min: Vec3::new(-3.0, -2.0, -1.0), max: Vec3::new(3.0, 2.0, 1.0) }.corners();
        for offset in [Vec3::ZERO, Vec3::splat(1e4)] {
            let points = corners.map(|corner| turn * corner + offset);
            let found = Obb::of_points(&points, &[]);
            assert!((found.surface() - 88.0).abs() < 0.5, "{found:?}");
            for point in points {
                let way = (point - found.centre).as_dvec3();
                for (axis, half) in found.axes.iter().zip(found.half.to_array()) {
                    assert!(way.dot(axis.as_dvec3()).abs() <= f64::from(half) + 1e-3);
                }
            }
        }
    }

    /// The overlap test counts on it (see [`crate::geometry::overlap`]).
    #[test]
    fn tight_boxes_have_right_angles_however_small_they_are() {
        for size in [1e-43, 1e-30, 3e-23, 1e-19, 1.0, 1e17] {
            for seed in 0..200 {
                let point = |i: u32| {
                    let part = |k: u32| {
                        (((seed * 31 + i * 7 + k).wrapping_mul(2_654_435_761)) >> 8) as f32 / 8_388_608.0
                            - 1.0
                    };
                    Vec3::new(part(0), part(1), part(2)) * size
                };
                let points: Vec<Vec3> = (0..3 + seed % 40).map(point).collect();
                let [u, v, w] = Obb::tight(&points).axes;
                for product in
                    [u.dot(v), v.dot(w), w.dot(u), u.length() - 1.0, v.length() - 1.0, w.length() - 1.0]
                {
                    assert!(product.abs() < 3e-7, "{size} {seed}: {product}");
                }
            }
        }
    }

    #[test]
    fn few_equal_and_odd_points() {
        assert!(Obb::of_points(&[], &[]).is_empty());
        let point = Obb::of_points(&[Vec3::ONE; 5], &[]);
        assert!(!point.is_empty() && point.half.max_element() < 1e-6);
        assert!(Obb::of_points(&[Vec3::ZERO, Vec3::NAN], &[]).is_nan());
        assert!(Obb::with_axes([Vec3::X, Vec3::X, Vec3::Y], &[Vec3::ZERO]).is_none());
        assert!(Obb::from(Aabb::EMPTY).is_empty());
        let flat = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)];
        assert!(Obb::of_points(&flat, &[]).half.min_element() < 1e-6);
    }
}
