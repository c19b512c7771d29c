//! A few points coordinate beside coordinate, so that what is asked of all is asked of four at a time.

use glam::{Vec3, Vec3A, Vec4};

/// A number of each point, in groups of four.
type Column<const G: usize> = [Vec4; G];

/// Points in groups of four. What is left of the groups is filled up with the last point, which changes no extreme.
pub(super) struct Columns<const G: usize> {
    axes: [Column<G>; 3],
    len: usize,
}

impl<const G: usize> Columns<G> {
    /// Up to four times `G` points, in metres.
    pub(super) fn of(points: &[Vec3]) -> Self {
        let mut axes = [[[0.0; 4]; G]; 3];
        if let Some(last) = points.last() {
            for i in 0..4 * G {
                let point = points.get(i).unwrap_or(last);
                axes.iter_mut().zip(point.to_array()).for_each(|(axis, at)| axis[i / 4][i % 4] = at);
            }
        }
        Self { axes: axes.map(|axis| axis.map(Vec4::from_array)), len: points.len() }
    }

    /// How many points there are.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// How far each lies along an axis.
    #[inline]
    pub(super) fn along(&self, axis: Vec3) -> Column<G> {
        let [x, y, z] = &self.axes;
        std::array::from_fn(|group| x[group] * axis.x + y[group] * axis.y + z[group] * axis.z)
    }

    /// Each one's way from a line through `point` in the direction `along`, a unit vector.
    #[inline]
    pub(super) fn off_line(&self, point: Vec3A, along: Vec3A) -> Self {
        let mut off = Self { axes: self.axes, len: self.len };
        let [x, y, z] = &mut off.axes;
        for group in 0..G {
            let way = [x[group] - point.x, y[group] - point.y, z[group] - point.z];
            let share = way[0] * along.x + way[1] * along.y + way[2] * along.z;
            x[group] = way[0] - share * along.x;
            y[group] = way[1] - share * along.y;
            z[group] = way[2] - share * along.z;
        }
        off
    }

    /// The one farthest from somewhere; that place itself if they are all there.
    #[inline]
    pub(super) fn farthest(&self, from: Vec3A) -> Vec3A {
        let (mut best, mut most) = (from, 0.0);
        let [x, y, z] = &self.axes;
        for group in 0..G {
            let [u, v, w] = [x[group] - from.x, y[group] - from.y, z[group] - from.z];
            let distances = u * u + v * v + w * w;
            for (lane, distance) in distances.to_array().into_iter().enumerate() {
                if distance > most {
                    (best, most) = (Vec3A::new(x[group][lane], y[group][lane], z[group][lane]), distance);
                }
            }
        }
        best
    }
}

/// From the least to the greatest of some numbers.
#[inline]
pub(super) fn extent<const G: usize>(numbers: &Column<G>) -> f32 {
    let (mut low, mut high) = (Vec4::INFINITY, Vec4::NEG_INFINITY);
    for number in numbers {
        (low, high) = (low.min(*number), high.max(*number));
    }
    high.max_element() - low.min_element()
}
