//! Which rays of many go in a packet: those that come one after the other, if they go the same way; where they do not,
//! those of the next some that do.

use super::packet::RAYS;
use crate::geometry::Ray;
use crate::geometry::hit::Way;

/// The fewest rays worth a packet.
const FEWEST: usize = RAYS / 2;

/// Among how many rays those are looked for that go the same way.
const AMONG: usize = 8 * RAYS;

/// How often that is in vain, in a row, before those left over are asked about one by one.
const VAIN: usize = 3;

/// How many packets' rays are asked about one by one at most, after those of several in a row have come apart, before
/// it is tried again.
const ALONE: usize = 7;

/// Answers for rays packet by packet, or for `one` where that does not pay. A packet tells whether it stayed together to
/// the end; or none, and no answers, if its rays do not go the same way.
pub(in crate::structure::bvh) fn in_packets<A: Copy + Default>(
    rays: &[Ray],
    answers: &mut [A],
    mut packet: impl FnMut(&[Ray], &mut [A]) -> Option<bool>,
    one: impl Fn(&Ray) -> A,
) {
    assert_eq!(rays.len(), answers.len(), "a place for the answer to each ray");
    let mut patience = Patience { alone: 0, next: 1 };
    for (rays, answers) in rays.chunks(AMONG).zip(answers.chunks_mut(AMONG)) {
        let mut left = Left { numbers: [0; AMONG], count: 0 };
        for (from, (rays, answers)) in
            (0..AMONG).step_by(RAYS).zip(rays.chunks(RAYS).zip(answers.chunks_mut(RAYS)))
        {
            if patience.is_out() {
                answers.iter_mut().zip(rays).for_each(|(answer, ray)| *answer = one(ray));
                continue;
            }
            match if rays.len() < FEWEST { None } else { packet(rays, answers) } {
                Some(stayed) => patience.learn(stayed),
                None => left.add(from..from + rays.len()),
            }
        }
        left.answer(rays, answers, &mut packet, &one);
    }
}

/// For how long no packets are tried.
struct Patience {
    /// How many packets' rays are to be asked about alone.
    alone: usize,
    /// How many it will be after the next that comes apart.
    next: usize,
}

impl Patience {
    fn is_out(&mut self) -> bool {
        let is_out = self.alone > 0;
        self.alone = self.alone.saturating_sub(1);
        is_out
    }

    fn learn(&mut self, stayed: bool) {
        (self.alone, self.next) = if stayed { (0, 1) } else { (self.next, ALONE.min(2 * self.next + 1)) };
    }
}

/// Rays that did not go the way of those beside them, by number.
struct Left {
    numbers: [u8; AMONG],
    count: usize,
}

impl Left {
    fn add(&mut self, numbers: std::ops::Range<usize>) {
        for number in numbers {
            self.numbers[self.count] = number as u8;
            self.count += 1;
        }
    }

    /// Answers for them, those that go the way of the first of them together, and so on.
    fn answer<A: Copy + Default>(
        mut self,
        rays: &[Ray],
        answers: &mut [A],
        packet: &mut impl FnMut(&[Ray], &mut [A]) -> Option<bool>,
        one: &impl Fn(&Ray) -> A,
    ) {
        if self.count >= FEWEST {
            self.answer_alike(rays, answers, packet, one);
        }
        for number in &self.numbers[..self.count] {
            answers[usize::from(*number)] = one(&rays[usize::from(*number)]);
        }
    }

    /// Answers until those that are left are too few, or go too many ways.
    fn answer_alike<A: Copy + Default>(
        &mut self,
        rays: &[Ray],
        answers: &mut [A],
        packet: &mut impl FnMut(&[Ray], &mut [A]) -> Option<bool>,
        one: &impl Fn(&Ray) -> A,
    ) {
        let mut ways = [Way::default(); AMONG];
        for number in &self.numbers[..self.count] {
            ways[usize::from(*number)] = Way::of(&rays[usize::from(*number)]);
        }
        let mut vain = 0;
        while self.count >= FEWEST && vain < VAIN {
            let (alike, count) = self.take_alike(&ways);
            let alike = &alike[..count];
            let (mut own, mut found) = ([rays[0]; RAYS], [A::default(); RAYS]);
            let (own, found) = (&mut own[..count], &mut found[..count]);
            own.iter_mut().zip(alike).for_each(|(own, number)| *own = rays[usize::from(*number)]);
            let together = if count < FEWEST { None } else { packet(own, found) };
            if together.is_none() {
                found.iter_mut().zip(own).for_each(|(found, ray)| *found = one(ray));
            }
            vain = if together == Some(true) { 0 } else { vain + 1 };
            alike.iter().zip(found).for_each(|(number, found)| answers[usize::from(*number)] = *found);
        }
    }

    /// Takes out the first and those that go its way, as many as go in a packet: their numbers, and how many.
    fn take_alike(&mut self, ways: &[Way; AMONG]) -> ([u8; RAYS], usize) {
        let (mut alike, mut count, mut kept) = ([0; RAYS], 0, 0);
        let first = ways[usize::from(self.numbers[0])];
        for at in 0..self.count {
            let number = self.numbers[at];
            if count < RAYS && ways[usize::from(number)].is_like(first) {
                alike[count] = number;
                count += 1;
            } else {
                self.numbers[kept] = number;
                kept += 1;
            }
        }
        // One that goes nowhere is not even like itself.
        if count == 0 {
            (alike[0], count) = (self.numbers[0], 1);
            self.numbers.copy_within(1.., 0);
            kept -= 1;
        }
        self.count = kept;
        (alike, count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use std::cell::RefCell;

    /// What is asked of rays that know their number, as their `far`: the packets, and who was asked about alone. A packet
    /// whose rays go different ways has no answer; one with ray 13 comes apart.
    fn asked(directions: &[Vec3]) -> (Vec<Vec<usize>>, Vec<usize>) {
        let rays: Vec<Ray> = (0..directions.len())
            .map(|number| Ray { far: number as f32, ..Ray::new(Vec3::ZERO, directions[number]) })
            .collect();
        let mut answers = vec![f32::NAN; rays.len()];
        let (packets, alone) = (RefCell::new(Vec::new()), RefCell::new(Vec::new()));
        let packet = |rays: &[Ray], answers: &mut [f32]| {
            if rays.iter().any(|ray| !Way::of(ray).is_like(Way::of(&rays[0]))) {
                return None;
            }
            answers.iter_mut().zip(rays).for_each(|(answer, ray)| *answer = ray.far);
            let numbers: Vec<usize> = rays.iter().map(|ray| ray.far as usize).collect();
            let stayed = !numbers.contains(&13);
            packets.borrow_mut().push(numbers);
            Some(stayed)
        };
        in_packets(&rays, &mut answers, packet, |ray| {
            alone.borrow_mut().push(ray.far as usize);
            ray.far
        });
        let answers: Vec<usize> = answers.into_iter().map(|answer| answer as usize).collect();
        assert_eq!(answers, (0..rays.len()).collect::<Vec<_>>(), "each its own answer");
        (packets.into_inner(), alone.into_inner())
    }

    #[test]
    fn rays_by_turns_go_with_those_that_go_their_way() {
        let ways = [Vec3::new(1.0, 0.1, 0.1), Vec3::new(-0.1, 1.0, 0.1)];
        let by_turns: Vec<Vec3> = (0..AMONG).map(|number| ways[number % 2]).collect();
        let (packets, alone) = asked(&by_turns);
        assert_eq!((packets.len(), alone.len()), (AMONG / RAYS, 0), "{packets:?} {alone:?}");
        for packet in &packets {
            assert!(packet.len() == RAYS && packet.iter().all(|number| number % 2 == packet[0] % 2));
        }
    }

    #[test]
    fn rays_that_go_everywhere_or_nowhere_are_asked_about_alone() {
        let everywhere = |number: usize| Vec3::new((number as f32).sin(), (number as f32 * 1.7).cos(), 0.3);
        let directions: Vec<Vec3> = (0..300).map(everywhere).collect();
        let (packets, alone) = asked(&directions);
        assert_eq!(packets.iter().map(Vec::len).sum::<usize>() + alone.len(), 300);
        assert!(alone.len() > 200, "{packets:?}");
        for nowhere in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
            let (packets, alone) = asked(&[nowhere; 40]);
            assert_eq!((packets.len(), alone.len()), (0, 40), "{nowhere}");
        }
    }

    #[test]
    fn after_packets_that_came_apart_the_next_go_alone() {
        // Of the first packet.
        let (packets, alone) = asked(&[Vec3::X; 5 * RAYS]);
        assert_eq!(alone, (RAYS..2 * RAYS).collect::<Vec<_>>());
        assert_eq!(packets.len(), 4);
        // Too few for one.
        let (packets, alone) = asked(&[Vec3::X; FEWEST - 1]);
        assert_eq!((packets.len(), alone.len()), (0, FEWEST - 1));
    }
}
