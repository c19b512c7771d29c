//! How rays go through a [`WideBvh`]: one at a time, or several that go the same way together.
//!
//! The widest vector unit there is does it; all answer the same bit for bit, as the box tests and the triangle tests
//! of all do the same operations in the same order.

mod boxes;
mod count;
mod gather;
mod list;
mod nearest;
mod packet;
mod single;
mod waiting;
mod walk;

pub use count::RayCounts;
pub(super) use count::{Count, Uncounted};
pub(super) use gather::in_packets;
pub use list::TriangleList;
pub(super) use packet::RAYS;
use packet::{Guess, Together, together as walk_together};
use single::through as walk_single;

use super::{Intersector, WideBvh};
use crate::geometry::hit::TriangleTest;
use crate::geometry::lanes::Kind;
use crate::geometry::{Hit, Ray, Unit};
use std::cell::Cell;

/// Declares a function that runs a traversal on the unit it is told, with that unit's lanes for nodes and for blocks.
macro_rules! on_unit_through {
    (fn $name:ident<$b:lifetime>($($argument:ident: $type:ty),*) -> $result:ty = $walk:ident $(, $const:ident)?) => {
        #[inline]
        fn $name<$b, T: TriangleTest, C: Count $(, const $const: bool)?>(
            unit: Unit, bvh: &$b WideBvh<T>, count: &mut C, $($argument: $type),*
        ) -> $result {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,bmi1,bmi2,popcnt,lzcnt")]
            fn avx2<$b, T: TriangleTest, C: Count $(, const $const: bool)?>(
                bvh: &$b WideBvh<T>, count: &mut C, $($argument: $type),*
            ) -> $result {
                use crate::geometry::lanes::x86::{Lanes4, Lanes8};
                // SAFETY: this function has the feature.
                unsafe { $walk::<Lanes8, Lanes4, T, C $(, $const)?>(bvh, count, $($argument),*) }
            }
            match unit.0 {
                // SAFETY: a `Unit` is only made where it is there, this one where the bit instructions are too.
                #[cfg(target_arch = "x86_64")]
                Kind::Avx2 => unsafe { avx2::<T, C $(, $const)?>(bvh, count, $($argument),*) },
                // SAFETY: every x86-64 processor has the unit.
                #[cfg(target_arch = "x86_64")]
                Kind::Sse2 => unsafe {
                    use crate::geometry::lanes::x86::Lanes4;
                    $walk::<Lanes4, Lanes4, T, C $(, $const)?>(bvh, count, $($argument),*)
                },
                // SAFETY: every 64-bit ARM processor with an operating system has the unit.
                #[cfg(target_arch = "aarch64")]
                Kind::Neon => unsafe {
                    use crate::geometry::lanes::arm::Lanes4;
                    $walk::<Lanes4, Lanes4, T, C $(, $const)?>(bvh, count, $($argument),*)
                },
                // SAFETY: one lane needs no unit.
                Kind::Scalar => unsafe { $walk::<f32, f32, T, C $(, $const)?>(bvh, count, $($argument),*) },
            }
        }
    };
}

on_unit_through!(fn through<'b>(ray: &Ray, guess: &mut Guess<'b>) -> Option<Hit> = walk_single, ANY);
on_unit_through!(fn together<'b>(rays: &[Ray], guess: &mut Guess<'b>) -> Option<Together> = walk_together, ANY);

impl<T: TriangleTest> WideBvh<T> {
    /// The nearest hit, by a vector unit of one's choice.
    #[inline]
    pub fn closest_on(&self, unit: Unit, ray: &Ray) -> Option<Hit> {
        self.closest_to(unit, ray, &mut Uncounted)
    }

    /// The nearest hit, and what it took to find it, which is added to `counts`.
    pub fn closest_counted(&self, ray: &Ray, counts: &mut RayCounts) -> Option<Hit> {
        self.closest_to(self.unit, ray, counts)
    }

    /// Whether there is any hit, by a vector unit of one's choice.
    #[inline]
    pub fn occluded_on(&self, unit: Unit, ray: &Ray) -> bool {
        self.occluded_to(unit, ray, &mut Uncounted)
    }

    /// Whether there is any hit, and what it took to find out, which is added to `counts`.
    pub fn occluded_counted(&self, ray: &Ray, counts: &mut RayCounts) -> bool {
        self.occluded_to(self.unit, ray, counts)
    }

    /// The nearest hits of rays that go much the same way, by a vector unit of one's choice. Where they turn out not to,
    /// they are asked about one by one, at little loss.
    ///
    /// # Panics
    /// If there are not as many `hits` as `rays`.
    pub fn closest_coherent_on(&self, unit: Unit, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.coherent::<_, false>(unit, rays, hits, |hit| hit);
    }

    /// Whether there is any hit, of rays that go much the same way, by a vector unit of one's choice. Where they turn out
    /// not to, they are asked about one by one, at little loss.
    ///
    /// # Panics
    /// If there are not as many `occluded` as `rays`.
    pub fn occluded_coherent_on(&self, unit: Unit, rays: &[Ray], occluded: &mut [bool]) {
        self.coherent::<_, true>(unit, rays, occluded, |hit| hit.is_some());
    }

    /// Answers for rays by the hits they have in packets, or alone.
    fn coherent<A: Copy + Default, const ANY: bool>(
        &self,
        unit: Unit,
        rays: &[Ray],
        answers: &mut [A],
        answer: impl Fn(Option<Hit>) -> A,
    ) {
        let guess = &Cell::new(Guess::default());
        let packet = |rays: &[Ray], answers: &mut [A]| {
            let mut now = guess.get();
            let Together { hits, stayed } = self.packet::<ANY>(unit, rays, &mut now)?;
            guess.set(now);
            answers.iter_mut().zip(hits).for_each(|(own, hit)| *own = answer(hit));
            Some(stayed)
        };
        let one = |ray: &Ray| {
            let mut now = guess.get();
            let hit = through::<T, _, ANY>(unit, self, &mut Uncounted, ray, &mut now);
            guess.set(now);
            answer(hit)
        };
        in_packets(rays, answers, packet, one);
    }

    /// What comes of a packet; `None` if its rays do not go the same way.
    fn packet<'b, const ANY: bool>(
        &'b self,
        unit: Unit,
        rays: &[Ray],
        guess: &mut Guess<'b>,
    ) -> Option<Together> {
        together::<T, _, ANY>(unit, self, &mut Uncounted, rays, guess)
    }

    #[inline]
    fn closest_to(&self, unit: Unit, ray: &Ray, count: &mut impl Count) -> Option<Hit> {
        through::<T, _, false>(unit, self, count, ray, &mut Guess::default())
    }

    #[inline]
    fn occluded_to(&self, unit: Unit, ray: &Ray, count: &mut impl Count) -> bool {
        through::<T, _, true>(unit, self, count, ray, &mut Guess::default()).is_some()
    }
}

impl<T: TriangleTest> Intersector for WideBvh<T> {
    #[inline]
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.closest_on(self.unit, ray)
    }

    #[inline]
    fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_on(self.unit, ray)
    }

    fn closest_coherent(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.closest_coherent_on(self.unit, rays, hits);
    }

    fn occluded_coherent(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.occluded_coherent_on(self.unit, rays, occluded);
    }
}

#[cfg(test)]
mod tests;
