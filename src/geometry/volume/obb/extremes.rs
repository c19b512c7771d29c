//! Axes for a tight box from the points that lie farthest along a few directions: what is done for each pair of
//! axes then costs the same for two hundred points as for two million.
//!
//! The way of Larsson and Kallberg's DiTO-14 (Fast computation of tight-fitting oriented bounding boxes, 2011): the
//! extreme points along seven directions; the two farthest apart and the one farthest from the line through them
//! make a triangle, the points farthest on either side of it two tetrahedra; each edge of each face gives a
//! candidate. Here the covariance's axes are a candidate too, or for a leaf's few points three planes that take less
//! time. These are judged by several turns, since a square is worst off along its diagonal, and the best of all is
//! turned about its thinnest side.

mod columns;

use columns::{Columns, extent};
use glam::{Vec3, Vec3A, Vec4};

/// Up to how many points all are looked at instead of the extreme ones.
const FEW: usize = 24;

/// Up to how many points, those of four triangles, planes through the two farthest apart stand for their covariance.
pub(super) const LEAF: usize = 12;

/// How many extreme points there are: two a direction.
const EXTREME: usize = 14;

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
    // As few groups of four as will do, and a number that the compiler knows.
    let best = match points.len() {
        0..=8 => Best::<2>::of(points).for_leaf(points),
        9..=LEAF => Best::<3>::of(points).for_leaf(points),
        13..=FEW => Best::<6>::of(points).for_few(principal()),
        _ => {
            let extreme = extreme_points(points);
            Best::<4>::of(&extreme).for_many(principal(), &extreme)
        }
    };
    [best, Vec3::AXES]
}

fn extreme_points(points: &[Vec3]) -> [Vec3; EXTREME] {
    let first = points.first().copied().unwrap_or_default();
    let mut extreme = [first; EXTREME];
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

struct Best<const G: usize> {
    points: Columns<G>,
    axes: [Vec3; 3],
    surface: f32,
}

impl<const G: usize> Best<G> {
    /// Those of the world, for some points.
    fn of(points: &[Vec3]) -> Self {
        let mut best = Self { points: Columns::of(points), axes: Vec3::AXES, surface: 0.0 };
        best.surface = best.surface_of(Vec3::AXES);
        best
    }

    /// The best for a leaf's points.
    fn for_leaf(mut self, points: &[Vec3]) -> [Vec3; 3] {
        if let Some(any) = points.first() {
            self.of_leaf((*any).into());
        }
        self.turned()
    }

    /// The best for a few points, given the axes of their covariance.
    fn for_few(mut self, principal: [Vec3; 3]) -> [Vec3; 3] {
        self.offer_turned(self.thinnest_last(principal), &[SOME]);
        self.turned()
    }

    /// The best for the extreme ones of many points, given the axes of the covariance of all.
    fn for_many(mut self, principal: [Vec3; 3], extreme: &[Vec3; EXTREME]) -> [Vec3; 3] {
        self.offer_turned(self.thinnest_last(principal), &[SOME]);
        self.of_tetrahedra(extreme);
        self.turned()
    }

    /// The extents of the box with these axes.
    fn extents(&self, axes: [Vec3; 3]) -> Vec3 {
        Vec3::from_array(axes.map(|axis| extent(&self.points.along(axis))))
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

    fn of_tetrahedra(&mut self, extreme: &[Vec3; EXTREME]) {
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
    /// the plane along both pairs: two triangles have no other that is large. `any` is one of the points.
    fn of_leaf(&mut self, any: Vec3A) {
        let a = self.points.farthest(any);
        let b = self.points.farthest(a);
        let Some(along) = (b - a).try_normalize() else { return };
        // Across that line: from the point farthest off it to the one farthest from that.
        let off = self.points.off_line(a, along);
        let c = off.farthest(Vec3A::ZERO);
        let d = off.farthest(c);
        for across in [c - d, c, d] {
            let Some(normal) = along.cross(across).try_normalize() else { continue };
            // As with a face: the normal may lean where all lie close to the line; the axes must not.
            let Some(side) = normal.cross(along).try_normalize() else { continue };
            let normal = along.cross(side).normalize_or_zero();
            // A square is worst off along its diagonal: a plane is judged by some of its turns.
            self.offer_turned([along, side, normal].map(Vec3::from), &[SOME]);
        }
    }

    /// The same axes, the one along which the box is thinnest last.
    fn thinnest_last(&self, axes: [Vec3; 3]) -> [Vec3; 3] {
        let extents = self.extents(axes);
        let thinnest = (0..3).min_by(|&i, &j| extents[i].total_cmp(&extents[j])).unwrap_or(0);
        [1, 2, 0].map(|step| axes[(thinnest + step) % 3])
    }

    /// The best so far, or turned about the axis along which the box is thinnest.
    fn turned(mut self) -> [Vec3; 3] {
        self.offer_turned(self.thinnest_last(self.axes), &TURNS);
        self.axes
    }

    /// Offers axes turned about the third, four turns at once.
    fn offer_turned(&mut self, [u, v, w]: [Vec3; 3], turns: &[Turns]) {
        let z = Vec4::splat(extent(&self.points.along(w)));
        let [along, across] = [u, v].map(|axis| self.points.along(axis).map(|four| four.to_array()));
        for turns in turns {
            let [cos, sin] = turns.map(Vec4::from_array);
            let (mut low, mut high) = ([Vec4::INFINITY; 2], [Vec4::NEG_INFINITY; 2]);
            let places = along.as_flattened().iter().zip(across.as_flattened());
            for (&a, &b) in places.take(self.points.len()) {
                let turned = [cos * a + sin * b, cos * b - sin * a];
                for (i, at) in turned.into_iter().enumerate() {
                    (low[i], high[i]) = (low[i].min(at), high[i].max(at));
                }
            }
            let [x, y] = [0, 1].map(|i| high[i] - low[i]);
            let surfaces = x * y + (x + y) * z;
            for (turn, surface) in surfaces.to_array().into_iter().enumerate() {
                if surface < self.surface {
                    let (cos, sin) = (turns[0][turn], turns[1][turn]);
                    (self.axes, self.surface) = ([u * cos + v * sin, v * cos - u * sin, w], surface);
                }
            }
        }
    }
}
