//! Axes for a tight box from the points that lie farthest along a few directions: what is done for each pair of
//! axes then costs the same for two hundred points as for two million.
//!
//! The way of Larsson and Kallberg's DiTO-14 (Fast computation of tight-fitting oriented bounding boxes, 2011): the
//! extreme points along seven directions; the two farthest apart and the one farthest from the line through them
//! make a triangle, the points farthest on either side of it two tetrahedra; each edge of each face gives a
//! candidate. Here the covariance's axes are a candidate too, or for a leaf's few points three planes that take less
//! time. These are judged by several turns, since a square is worst off along its diagonal, and the best of all is
//! turned about its thinnest side.

use glam::{Mat3A, Vec3, Vec3A, Vec4};

/// Up to how many points all are looked at instead of the extreme ones.
const FEW: usize = 24;

/// Up to how many points, those of four triangles, planes through the two farthest apart stand for their covariance.
const LEAF: usize = 12;

/// Cosines and sines of four turns. They are written down, because to work them out takes longer than to try them.
type Turns = [[f32; 4]; 2];

/// None, then a quarter of a right angle more each.
const SOME: Turns =
    [[1.0, 0.923_879_5, 0.707_106_77, 0.382_683_43], [0.0, 0.382_683_43, 0.707_106_77, 0.923_879_5]];

/// The turns that are tried about the thinnest side: none, then a sixteenth of a right angle
/// more each.
const TURNS: [Turns; 4] = [
    [[1.0, 0.995_184_7, 0.980_785_25, 0.956_940_35], [0.0, 0.098_017_14, 0.195_090_32, 0.290_284_66]],
    [
        [0.923_879_5, 0.881_921_3, 0.831_469_6, 0.773_010_43],
        [0.382_683_43, 0.471_396_74, 0.555_570_24, 0.634_393_3],
    ],
    [
        [0.707_106_77, 0.634_393_3, 0.555_570_24, 0.471_396_74],
        [0.707_106_77, 0.773_010_43, 0.831_469_6, 0.881_921_3],
    ],
    [
        [0.382_683_43, 0.290_284_66, 0.195_090_32, 0.098_017_14],
        [0.923_879_5, 0.956_940_35, 0.980_785_25, 0.995_184_7],
    ],
];

/// Axes to try for a box around some points, the best first; the world's come last.
pub(super) fn axes(points: &[Vec3], principal: impl FnOnce() -> [Vec3; 3]) -> [[Vec3; 3]; 2] {
    let extreme;
    let measured: &[Vec3] = if points.len() <= FEW {
        points
    } else {
        extreme = extreme_points(points);
        &extreme
    };
    let mut lanes = [Vec3A::ZERO; FEW];
    lanes.iter_mut().zip(measured).for_each(|(lane, point)| *lane = (*point).into());
    let mut best = Best { points: &lanes[..measured.len()], axes: Vec3::AXES, surface: 0.0 };
    best.surface = best.surface_of(Vec3::AXES);
    if points.len() > LEAF {
        let axes = best.thinnest_last(principal());
        best.offer_turned(axes, &SOME);
    } else {
        best.of_leaf();
    }
    if points.len() > FEW {
        best.of_tetrahedra(measured);
    }
    best.turn();
    [best.axes, Vec3::AXES]
}

fn extreme_points(points: &[Vec3]) -> [Vec3; 14] {
    let first = points.first().copied().unwrap_or_default();
    let mut extreme = [first; 14];
    let (mut low, mut high) = (along(first), along(first));
    for &point in points {
        let now = along(point);
        // Seldom: the extremes are found early.
        let new = |i: usize| now[i].cmplt(low[i]) | now[i].cmpgt(high[i]);
        if new(0).any() || new(1).any() {
            for direction in 0..7 {
                let (half, lane) = (direction / 4, direction % 4);
                let here = now[half][lane];
                if here < low[half][lane] {
                    (low[half][lane], extreme[2 * direction]) = (here, point);
                }
                if here > high[half][lane] {
                    (high[half][lane], extreme[2 * direction + 1]) = (here, point);
                }
            }
        }
    }
    extreme
}

/// How far a point lies along each of the seven directions: the four corners of a cube, and three faces.
fn along(Vec3 { x, y, z }: Vec3) -> [Vec4; 2] {
    let (plus, minus) = (x + y, x - y);
    [Vec4::new(plus + z, plus - z, minus + z, minus - z), Vec4::new(x, y, z, 0.0)]
}

struct Best<'a> {
    points: &'a [Vec3A],
    axes: [Vec3; 3],
    surface: f32,
}

impl Best<'_> {
    /// The extents of the box with these axes.
    fn extents(&self, axes: [Vec3; 3]) -> Vec3A {
        // All three products of a point at once.
        let along = Mat3A::from_cols_array_2d(&axes.map(|axis| axis.to_array())).transpose();
        let (mut low, mut high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        for point in self.points {
            let at = along * *point;
            (low, high) = (low.min(at), high.max(at));
        }
        high - low
    }

    /// Half the surface of the box with these axes.
    fn surface_of(&self, axes: [Vec3; 3]) -> f32 {
        let extents = self.extents(axes);
        extents.x * extents.y + extents.y * extents.z + extents.z * extents.x
    }

    /// Takes these axes if they are better; a number that is none is not.
    fn offer(&mut self, axes: [Vec3; 3]) {
        let surface = self.surface_of(axes);
        if surface < self.surface {
            (self.axes, self.surface) = (axes, surface);
        }
    }

    /// Offers an edge, the normal of a face it lies in, and what is at right angles to both.
    fn offer_face(&mut self, corners: [Vec3; 3]) {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        if normal == Vec3::ZERO {
            return;
        }
        for (i, &corner) in corners.iter().enumerate() {
            let Some(edge) = (corners[(i + 1) % 3] - corner).try_normalize() else { continue };
            // The normal of a flat triangle may lean; the third axis must not.
            let Some(side) = normal.cross(edge).try_normalize() else { continue };
            self.offer([edge, side, edge.cross(side).normalize_or_zero()]);
        }
    }

    fn of_tetrahedra(&mut self, extreme: &[Vec3]) {
        let pairs = extreme.as_chunks::<2>().0;
        let Some([a, b]) = pairs
            .iter()
            .copied()
            .max_by(|p, q| p[0].distance_squared(p[1]).total_cmp(&q[0].distance_squared(q[1])))
        else {
            return;
        };
        let Some(along) = (b - a).try_normalize() else { return };
        let off = |point: &Vec3| (*point - a).reject_from_normalized(along).length_squared();
        let Some(&c) = extreme.iter().max_by(|p, q| off(p).total_cmp(&off(q))) else { return };
        self.offer_face([a, b, c]);
        let normal = (b - a).cross(c - a);
        let height = |point: &Vec3| normal.dot(*point - a);
        for side in [1.0, -1.0] {
            let top = extreme.iter().max_by(|p, q| (side * height(p)).total_cmp(&(side * height(q))));
            if let Some(&top) = top.filter(|top| side * height(top) > 0.0) {
                for [from, to] in [[a, b], [b, c], [c, a]] {
                    self.offer_face([from, to, top]);
                }
            }
        }
    }

    /// Offers the planes through the two points farthest apart and those farthest off their line, to either side, and
    /// the plane along both pairs: two triangles have no other that is large.
    fn of_leaf(&mut self) {
        let Some(&any) = self.points.first() else { return };
        let a = self.farthest(any, |point| point);
        let b = self.farthest(a, |point| point);
        let Some(along) = (b - a).try_normalize() else { return };
        // Across that line: from the point farthest off it to the one farthest from that.
        let off = |point: Vec3A| (point - a).reject_from_normalized(along);
        let c = self.farthest(Vec3A::ZERO, off);
        let d = self.farthest(c, off);
        for across in [c - d, c, d] {
            let Some(normal) = along.cross(across).try_normalize() else { continue };
            // As with a face: the normal may lean where all lie close to the line; the axes must not.
            let Some(side) = normal.cross(along).try_normalize() else { continue };
            let normal = along.cross(side).normalize_or_zero();
            // A square is worst off along its diagonal: a plane is judged by some of its turns.
            self.offer_turned([along, side, normal].map(Vec3::from), &SOME);
        }
    }

    /// What is farthest from somewhere, of what a function makes of the points.
    fn farthest(&self, from: Vec3A, made: impl Fn(Vec3A) -> Vec3A) -> Vec3A {
        let (mut best, mut most) = (from, 0.0);
        for point in self.points {
            let there = made(*point);
            let distance = there.distance_squared(from);
            if distance > most {
                (best, most) = (there, distance);
            }
        }
        best
    }

    /// The same axes, the one along which the box is thinnest last.
    fn thinnest_last(&self, axes: [Vec3; 3]) -> [Vec3; 3] {
        let extents = self.extents(axes);
        let thinnest = (0..3).min_by(|&i, &j| extents[i].total_cmp(&extents[j])).unwrap_or(0);
        [1, 2, 0].map(|step| axes[(thinnest + step) % 3])
    }

    /// Tries turns about the axis along which the box is thinnest.
    fn turn(&mut self) {
        let axes = self.thinnest_last(self.axes);
        TURNS.iter().for_each(|turns| self.offer_turned(axes, turns));
    }

    /// Offers axes turned about the third, four turns at once.
    fn offer_turned(&mut self, [u, v, w]: [Vec3; 3], turns: &Turns) {
        let [along, across, up] = [u, v, w].map(Vec3A::from);
        let [cos, sin] = turns.map(Vec4::from_array);
        let (mut low, mut high) = ([Vec4::INFINITY; 3], [Vec4::NEG_INFINITY; 3]);
        for point in self.points {
            let (a, b) = (along.dot(*point), across.dot(*point));
            let turned = [cos * a + sin * b, cos * b - sin * a, Vec4::splat(up.dot(*point))];
            for (i, at) in turned.into_iter().enumerate() {
                (low[i], high[i]) = (low[i].min(at), high[i].max(at));
            }
        }
        let [x, y, z] = [0, 1, 2].map(|i| high[i] - low[i]);
        let surfaces = x * y + (x + y) * z;
        for (turn, surface) in surfaces.to_array().into_iter().enumerate() {
            if surface < self.surface {
                let (cos, sin) = (turns[0][turn], turns[1][turn]);
                (self.axes, self.surface) = ([u * cos + v * sin, v * cos - u * sin, w], surface);
            }
        }
    }
}
