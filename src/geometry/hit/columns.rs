//! Several rays that go much the same way, made ready all at once: bit for bit what [`Aim`] makes of each.

use super::Scale;
use super::aim::{AS_THEY_ARE, AXES, Aim, Beam, LEAST_PART, SLACK};
use super::span::{APART, Span};
use crate::geometry::Ray;
use crate::geometry::lanes::Lanes;
use glam::Vec3A;

/// Rays.
const RAYS: usize = 16;

/// What beams hold of 16 rays that have octant and axes in common, and more of each ray.
#[derive(Clone, Copy)]
pub(crate) struct Columns {
    /// By number of the part, then by ray: three each of origin, direction, first and last rate, and shear.
    parts: [[f32; RAYS]; 15],
    pub(crate) near: [f32; RAYS],
    pub(crate) far: [f32; RAYS],
    /// As [`Aim::own_t`] has them.
    stretch: [f32; RAYS],
    start: [f32; RAYS],
    axes: [usize; 3],
    rises: [bool; 3],
}

/// A ray as it is: origin, direction, near, far.
type Row = [f32; 8];

impl Columns {
    /// Rays, 16 at most, of fewer the first as often as it takes, and what they span: with `ANY` seen from where they end,
    /// if that is closer together. `None` if they do not go much the same way, all in one octant and none parallel to a
    /// plane of an axis, or one meets nothing whatever there is.
    ///
    /// # Safety
    /// The processor has the lanes' vector unit.
    #[inline(always)]
    pub(crate) unsafe fn of<L: Lanes, const ANY: bool>(rays: &[Ray], scale: Scale) -> Option<(Self, Span)> {
        let mut rows = [[0.0; 8]; RAYS];
        for (at, row) in rows.iter_mut().enumerate() {
            *row = plain(rays.get(at).unwrap_or(&rays[0]));
        }
        // SAFETY: the processor is the caller's.
        unsafe {
            let bounds = Bounds::of::<L>(&rows)?;
            if !bounds.are_of_one_octant() {
                return None;
            }
            if bounds.are_tame(greatest_axis(&rows[0]), scale) {
                return Self::of_rows::<L, ANY>(&rows, bounds, scale.factor());
            }
            let (mut stretch, mut start) = ([0.0; RAYS], [0.0; RAYS]);
            for (at, row) in rows.iter_mut().enumerate() {
                let aim = Aim::new(rays.get(at).unwrap_or(&rays[0]), scale)?;
                let ([x, y, z], [to_x, to_y, to_z]) = (aim.origin.to_array(), aim.direction.to_array());
                *row = [x, y, z, to_x, to_y, to_z, aim.near, aim.far];
                (stretch[at], start[at]) = (aim.stretch, aim.start);
            }
            let (columns, span) = Self::of_rows::<L, ANY>(&rows, Bounds::of::<L>(&rows)?, 1.0)?;
            Some((Self { stretch, start, ..columns }, span))
        }
    }

    /// The same of rays that take so many lengths for each of theirs, and nothing else.
    ///
    /// # Safety
    /// The processor has the lanes' vector unit.
    #[inline(always)]
    unsafe fn of_rows<L: Lanes, const ANY: bool>(
        rows: &[Row; RAYS],
        bounds: Bounds,
        lengths: f32,
    ) -> Option<(Self, Span)> {
        let first = Vec3A::new(rows[0][3], rows[0][4], rows[0][5]);
        let [low, high] = bounds.part(0).map(|origin| origin * lengths);
        let [least, greatest] = bounds.part(3);
        let falls = least.is_negative_bitmask();
        let rises = [falls & 1 == 0, falls & 2 == 0, falls & 4 == 0];
        let apart = (greatest - first).max(first - least).max_element();
        let [least, greatest] = [least * lengths, greatest * lengths];
        let go_along = bounds.are_of_one_octant()
            && least.abs().min(greatest.abs()).min_element() >= LEAST_PART
            && apart <= APART * first.abs().max_element();
        if !(go_along && low.is_finite() && high.is_finite()) {
            return None;
        }
        let z = greatest_axis(&rows[0]);
        let [x, y, _] = AXES[z].map(usize::from);
        let (mut origins, mut ways, mut reaches) = ([[0.0; RAYS]; 3], [[0.0; RAYS]; 3], [[0.0; RAYS]; 2]);
        for (ray, [x, y, z, to_x, to_y, to_z, near, far]) in rows.iter().enumerate() {
            (origins[0][ray], origins[1][ray], origins[2][ray]) = (*x, *y, *z);
            (ways[0][ray], ways[1][ray], ways[2][ray]) = (*to_x, *to_y, *to_z);
            (reaches[0][ray], reaches[1][ray]) = (*near, *far);
        }
        let mut columns = Self {
            parts: [[0.0; RAYS]; 15],
            near: [0.0; RAYS],
            far: [0.0; RAYS],
            stretch: [1.0; RAYS],
            start: [0.0; RAYS],
            axes: [x, y, z],
            rises,
        };
        let parts = &mut columns.parts;
        let mut ends: Option<[[L; 3]; 2]> = None;
        for from in (0..RAYS).step_by(L::LEN) {
            // SAFETY: the processor is the caller's; `from` steps by the lanes' number below 16.
            unsafe {
                let origin = times(load(&origins, from), L::splat(lengths));
                let to = times(load(&ways, from), L::splat(lengths));
                let sizes = [to[0].abs(), to[1].abs(), to[2].abs()];
                let rises_above = sizes[1].greater(sizes[0]);
                // Adding zero takes the sign from a zero.
                let near = L::load(&reaches[0], from).add(L::splat(0.0));
                let far = L::load(&reaches[1], from).min(L::splat(f32::MAX));
                let all = far.at_least(far);
                let is_greatest = match z {
                    0 => !(rises_above | sizes[2].greater(sizes[0])),
                    1 => rises_above & !sizes[2].greater(sizes[1]),
                    _ => sizes[2].greater(sizes[0].max(sizes[1])),
                };
                if is_greatest & all != all || far.at_least(near) != all {
                    return None;
                }
                let one = L::splat(1.0);
                let rate = [one.div(to[0]), one.div(to[1]), one.div(to[2])];
                for axis in 0..3 {
                    origin[axis].store(&mut parts[axis], from);
                    to[axis].store(&mut parts[3 + axis], from);
                    rate[axis].mul(L::splat(1.0 - SLACK)).store(&mut parts[6 + axis], from);
                    rate[axis].mul(L::splat(1.0 + SLACK)).store(&mut parts[9 + axis], from);
                }
                to[x].mul(rate[z]).store(&mut parts[12], from);
                to[y].mul(rate[z]).store(&mut parts[13], from);
                rate[z].store(&mut parts[14], from);
                near.store(&mut columns.near, from);
                far.store(&mut columns.far, from);
                if ANY {
                    let way = times(to, far);
                    let [x, y, z] = [origin[0].add(way[0]), origin[1].add(way[1]), origin[2].add(way[2])];
                    ends = Some(match ends {
                        None => [[x, y, z]; 2],
                        Some([low, high]) => [
                            [low[0].min(x), low[1].min(y), low[2].min(z)],
                            [high[0].max(x), high[1].max(y), high[2].max(z)],
                        ],
                    });
                }
            }
        }
        let rates = [greatest.recip(), least.recip()];
        let up = rises.into();
        let far = bounds.greatest[7].min(f32::MAX);
        let span = Span {
            first_origin: Vec3A::select(up, high, low),
            last_origin: Vec3A::select(up, low, high),
            first_rate: rates.map(|rate| rate * (1.0 - SLACK)),
            last_rate: rates.map(|rate| rate * (1.0 + SLACK)),
            near: bounds.least[6] + 0.0,
            far,
            rises,
        };
        let way = least.abs().max(greatest.abs()).max_element() * far;
        let back = match ends {
            // SAFETY: the processor is the caller's. No closure, which would not have its instructions.
            Some(ends) => span.back(unsafe { across(ends) }, way),
            None => None,
        };
        Some((columns, back.unwrap_or(span)))
    }

    /// A distance along a ray as the ray it was made of counts.
    #[inline]
    pub(crate) fn own_t(&self, ray: usize, t: f32) -> f32 {
        t * self.stretch[ray] + self.start[ray]
    }
}

impl<L: Lanes> Beam<L> {
    /// Some rays of several, from `from` on, one a lane.
    ///
    /// # Safety
    /// The processor has the lanes' vector unit, and there are as many rays from `from` on as lanes.
    #[inline(always)]
    pub(crate) unsafe fn several(rays: &Columns, from: usize) -> Self {
        let three = rays.parts.as_chunks::<3>().0;
        let [x, y, z] = rays.axes;
        // SAFETY: the processor is the caller's, and so is what there is to load.
        unsafe {
            let origin = load(&three[0], from);
            Self {
                origin,
                direction: load(&three[1], from),
                first_rate: load(&three[2], from),
                last_rate: load(&three[3], from),
                shear: load(&three[4], from),
                from: [origin[x], origin[y], origin[z]],
                axes: rays.axes,
                rises: rays.rises,
            }
        }
    }
}

/// # Safety
/// The processor has the lanes' vector unit, and there are as many numbers from `from` on as lanes.
#[inline(always)]
unsafe fn load<L: Lanes>([x, y, z]: &[[f32; RAYS]; 3], from: usize) -> [L; 3] {
    // SAFETY: the processor and what there is to load are the caller's.
    unsafe { [L::load(x, from), L::load(y, from), L::load(z, from)] }
}

#[inline(always)]
fn plain(ray: &Ray) -> Row {
    let ([x, y, z], [to_x, to_y, to_z]) = (ray.origin.to_array(), ray.direction.to_array());
    [x, y, z, to_x, to_y, to_z, ray.near, ray.far]
}

/// Along which axis a ray goes most, as [`Aim::new`] has it.
#[inline(always)]
fn greatest_axis(row: &Row) -> usize {
    let sizes = [row[3].abs(), row[4].abs(), row[5].abs()];
    let z = usize::from(sizes[1] > sizes[0]);
    if sizes[2] > sizes[z] { 2 } else { z }
}

/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
unsafe fn times<L: Lanes>([x, y, z]: [L; 3], by: L) -> [L; 3] {
    // SAFETY: the processor is the caller's.
    unsafe { [x.mul(by), y.mul(by), z.mul(by)] }
}

/// The least and the greatest over all lanes.
///
/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
unsafe fn across<L: Lanes>(ends: [[L; 3]; 2]) -> [Vec3A; 2] {
    let mut columns = [[[0.0; 16]; 3]; 2];
    for (columns, lanes) in columns.iter_mut().zip(ends) {
        for (column, lanes) in columns.iter_mut().zip(lanes) {
            // SAFETY: the processor is the caller's, and no vector has more than 16 lanes.
            unsafe { lanes.store(column, 0) };
        }
    }
    let at = |columns: &[[f32; 16]; 3], lane: usize| {
        Vec3A::new(columns[0][lane], columns[1][lane], columns[2][lane])
    };
    let [low, high] = &columns;
    let lanes = 1..L::LEN;
    [
        lanes.clone().fold(at(low, 0), |so_far, lane| so_far.min(at(low, lane))),
        lanes.fold(at(high, 0), |so_far, lane| so_far.max(at(high, lane))),
    ]
}

/// What all parts of some rays lie between.
struct Bounds {
    least: Row,
    greatest: Row,
}

impl Bounds {
    /// None if there is a NaN among them.
    ///
    /// # Safety
    /// The processor has the lanes' vector unit.
    #[inline(always)]
    unsafe fn of<L: Lanes>(rows: &[Row; RAYS]) -> Option<Self> {
        const { assert!(L::LEN <= 8, "a row holds no more") };
        let mut bounds = Self { least: rows[0], greatest: rows[0] };
        for from in (0..8).step_by(L::LEN) {
            // SAFETY: the processor is the caller's; `from` steps by the lanes' number below 8.
            unsafe {
                let first = L::load(&rows[0], from);
                let (mut least, mut greatest) = (first, first);
                let (all, mut ordered) = (L::splat(0.0).at_least(L::splat(0.0)), first.at_least(first));
                for row in &rows[1..] {
                    let row = L::load(row, from);
                    (least, greatest) = (least.min(row), greatest.max(row));
                    ordered &= row.at_least(row);
                }
                if ordered != all {
                    return None;
                }
                least.store(&mut bounds.least, from);
                greatest.store(&mut bounds.greatest, from);
            }
        }
        Some(bounds)
    }

    /// The least and the greatest of three parts from one on.
    #[inline(always)]
    fn part(&self, from: usize) -> [Vec3A; 2] {
        [&self.least, &self.greatest].map(|row| Vec3A::new(row[from], row[from + 1], row[from + 2]))
    }

    /// Whether all directions' parts are of one sign, and none zero.
    #[inline(always)]
    fn are_of_one_octant(&self) -> bool {
        let of_one_sign = |axis: usize| self.least[3 + axis] > 0.0 || self.greatest[3 + axis] < 0.0;
        of_one_sign(0) && of_one_sign(1) && of_one_sign(2)
    }

    /// Whether [`Aim::new`] takes rays as they are, which begin at their origins and go most along that axis.
    #[inline(always)]
    fn are_tame(&self, axis: usize, scale: Scale) -> bool {
        let ends = [self.least, self.greatest].map(|row| row[3 + axis].abs() * scale.factor());
        self.least[6] >= 0.0 && AS_THEY_ARE.contains(&ends[0]) && AS_THEY_ARE.contains(&ends[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Column by column, also of rays that are lengthened or moved first, and of too few.
    fn hold<L: Lanes>(rays: &[Ray], scale: Scale) -> bool {
        // SAFETY: one lane needs no unit.
        let Some((columns, _)) = (unsafe { Columns::of::<L, true>(rays, scale) }) else { return false };
        for ray in 0..RAYS {
            let aim = Aim::new(rays.get(ray).unwrap_or(&rays[0]), scale).expect("it is in a packet");
            // SAFETY: as above.
            let (own, expected) = unsafe { (Beam::<f32>::several(&columns, ray), Beam::<f32>::one(&aim)) };
            let parts = |beam: Beam<f32>| {
                [beam.origin, beam.direction, beam.first_rate, beam.last_rate, beam.shear, beam.from]
                    .map(|part| part.map(f32::to_bits))
            };
            assert_eq!(parts(own), parts(expected), "{ray} of {rays:?}");
            assert_eq!((own.axes, own.rises), (expected.axes, expected.rises));
            assert_eq!(
                [columns.near[ray], columns.far[ray]].map(f32::to_bits),
                [aim.near, aim.far].map(f32::to_bits)
            );
            assert_eq!(columns.own_t(ray, 0.75), aim.own_t(0.75));
        }
        true
    }

    #[test]
    fn columns_hold_what_each_ray_is_alone() {
        let mut held = 0;
        for number in 0..600_u32 {
            let part =
                |seed: u32| (number.wrapping_mul(2_654_435_761).wrapping_add(seed * 40_503) >> 7) as f32;
            let point =
                |seed: u32| Vec3::new(part(seed), part(seed + 1), part(seed + 2)) / (1 << 25) as f32 - 0.5;
            let length = [1.0, 300.0, 1e-6, 1e9, 1e-20][number as usize % 5];
            let (way, near) = (point(3) * 2.0, [0.0, -0.0, 0.25, -0.5][number as usize / 5 % 4]);
            let far = [1.0, f32::INFINITY, 1e20][number as usize / 20 % 3];
            let rays: Vec<Ray> = (0..[16, 9][number as usize % 2])
                .map(|ray| {
                    let beside = (point(10 + 6 * ray) + point(13 + 6 * ray)) * 0.02;
                    Ray { origin: point(0) + beside, direction: (way + beside) * length, near, far }
                })
                .collect();
            let scale = Scale::of([Vec3::splat([1.0, 3e4, 1e-8][number as usize % 3])]);
            held += usize::from(hold::<f32>(&rays, scale));
        }
        assert!(held > 300, "{held} of 600 are packets");
    }

    #[test]
    fn what_meets_nothing_or_goes_its_own_way_is_in_no_packet() {
        let ray = Ray::new(Vec3::ZERO, Vec3::new(1.0, 0.9, 0.8));
        let scale = Scale::of([Vec3::ONE]);
        assert!(hold::<f32>(&[ray; 3], scale));
        for bad in [
            Ray::new(Vec3::NAN, ray.direction),
            Ray::new(Vec3::INFINITY, ray.direction),
            Ray::new(Vec3::ZERO, Vec3::new(1.0, 0.9, 0.0)),
            Ray::new(Vec3::ZERO, Vec3::new(1.0, 0.9, -0.1)),
            Ray::new(Vec3::ZERO, Vec3::new(0.9, 1.0, 0.8)),
            Ray::new(Vec3::ZERO, Vec3::new(1.0, f32::NAN, 0.8)),
            Ray::new(Vec3::ZERO, Vec3::splat(f32::INFINITY)),
            Ray { near: 2.0, far: 1.0, ..ray },
            Ray { far: f32::NAN, ..ray },
        ] {
            assert!(!hold::<f32>(&[ray, bad], scale), "{bad:?}");
        }
    }
}
