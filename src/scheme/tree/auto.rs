//! Chooses scheme and processors, run by run, by what was measured on this very work: "model no more than
//! a scene needs", and one processor is a good answer.
//!
//! How many tasks a run will have is taken from the run before, as frames are alike; [`Choice`] says which
//! way suits so many. What is well known is not timed each time: of runs on one processor every 256th is
//! unless they grow, of shared ones of much the same size every 8th; the others cost a counter and two
//! branches. Nothing is tried before the time it takes to start a run on the machine (its team may sleep) is
//! under 2 % of what serial runs have taken so far.
//!
//! Settings: those of the schemes it tries (`choice::SCHEMES`).

use super::choice::{self, Choice, Way};
use super::serial::Serial;
use super::{AnyScheme, Share, TreeWork};
use crate::machine::{Machine, RunError};
use crate::scheme::{SettingError, Settings};
use std::ops::RangeInclusive;

pub(super) const SUMMARY: &str = "the scheme and processors that prove fastest for runs of a size, or one";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = true;

pub(super) struct Auto<M: Machine> {
    serial: Serial<M>,
    /// By scheme and level; made when first tried.
    shared: [Vec<Option<AnyScheme<M>>>; choice::SCHEMES.len()],
    /// Processors by level.
    levels: Vec<usize>,
    settings: Settings,
    choice: Choice,
    /// Tasks of the last run.
    tasks: u64,
    untimed: Untimed,
    /// Ticks that serial runs have to take before anything else is tried.
    unpaid: f64,
}

/// Runs to go without a look at the clock, as long as their tasks stay in a range.
struct Untimed {
    left: u32,
    way: Way,
    tasks: RangeInclusive<u64>,
}

/// Runs between two looks at the clock, on one processor and shared.
const UNTIMED: [u32; 2] = [255, 7];
/// The start of a shared run as a part of the serial runs before it.
const PRICE: f64 = 0.02;

impl<M: Machine> Auto<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        let levels = choice::levels(processors);
        let mut shared = choice::SCHEMES.map(|_| levels.iter().map(|_| None).collect::<Vec<_>>());
        // At the first level at once, so that settings which are off are told now.
        for (scheme, name) in shared.iter_mut().zip(choice::SCHEMES) {
            if let (Some(first), Some(&processors)) = (scheme.first_mut(), levels.first()) {
                *first = Some(AnyScheme::new(name, machine, processors, settings)?);
            }
        }
        let start = levels.first().map_or(0, |&processors| machine.start_ticks(processors));
        Ok(Auto {
            serial: Serial::new(machine, 1, settings)?,
            shared,
            choice: Choice::new(levels.clone()),
            levels,
            settings: settings.clone(),
            tasks: 0,
            untimed: Untimed { left: 0, way: Way::Serial, tasks: 0..=0 },
            unpaid: start as f64 / PRICE,
        })
    }

    #[inline]
    pub(super) fn run<W: TreeWork>(
        &mut self,
        machine: &M,
        work: &W,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        if self.untimed.left == 0 || !self.untimed.tasks.contains(&self.tasks) {
            return self.timed(machine, work);
        }
        self.untimed.left -= 1;
        self.go(self.untimed.way, machine, work)
    }

    #[inline]
    fn go<W: TreeWork>(&mut self, way: Way, machine: &M, work: &W) -> Result<Vec<Share<W::Found>>, RunError> {
        let shares = match way {
            Way::Serial => self.serial.run(machine, work)?,
            Way::Shared { scheme, level } => self.shared(scheme, level, machine).run(machine, work)?,
        };
        self.tasks = shares.iter().map(|share| share.visited).sum();
        Ok(shares)
    }

    fn timed<W: TreeWork>(&mut self, machine: &M, work: &W) -> Result<Vec<Share<W::Found>>, RunError> {
        let way = if self.unpaid > 0.0 { Way::Serial } else { self.choice.next(self.tasks) };
        let before = machine.now();
        let shares = self.go(way, machine, work)?;
        let ticks = machine.now().saturating_sub(before).max(1);
        self.choice.ran(way, self.tasks, ticks);
        if way == Way::Serial {
            self.unpaid -= ticks as f64;
        }
        self.look_away(way, ticks);
        Ok(shares)
    }

    /// Settles for how many runs the clock is left alone, after one that took so many ticks.
    fn look_away(&mut self, way: Way, ticks: u64) {
        let [serial, shared] = UNTIMED;
        let tasks = self.tasks;
        let (left, range) = if self.unpaid > 0.0 {
            // Until it is paid, as far as runs are alike.
            (serial.min((self.unpaid / ticks as f64) as u32), 0..=2 * tasks)
        } else if !self.choice.is_settled(way) || self.choice.next(tasks) != way {
            (0, 0..=0)
        } else if way == Way::Serial {
            (serial, 0..=self.choice.serial_up_to(tasks))
        } else {
            (shared, tasks - tasks / 8..=tasks + tasks / 8)
        };
        if way == Way::Serial {
            self.unpaid -= ticks as f64 * f64::from(left);
        }
        self.choice.age(left as i32);
        self.untimed = Untimed { left, way, tasks: range };
    }

    fn shared(&mut self, scheme: usize, level: usize, machine: &M) -> &mut AnyScheme<M> {
        self.shared[scheme][level].get_or_insert_with(|| {
            AnyScheme::new(choice::SCHEMES[scheme], machine, self.levels[level], &self.settings)
                .expect("these settings were taken at the first level")
        })
    }
}
