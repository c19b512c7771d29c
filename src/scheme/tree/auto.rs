//! Chooses scheme and processors, run by run, by what was measured on this very work: "model no more than
//! a scene needs", and one processor is a good answer.
//!
//! How many tasks a run will have is taken from the run before, as frames are alike; [`Choice`] says which
//! way suits so many. Where that is one processor, the next 256 runs are not even timed unless they grow:
//! they cost a counter and two branches. Nothing is tried before the time it takes to start a run on
//! the machine (its team may sleep) is under 2 % of what serial runs have taken so far.
//!
//! Settings: those of the schemes it tries (`choice::SCHEMES`).

use super::choice::{self, Choice, Way};
use super::serial::Serial;
use super::{AnyScheme, Share, TreeWork};
use crate::machine::{Machine, RunError};
use crate::scheme::{SettingError, Settings};

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
    /// Serial runs to go without a look at the clock, as long as none has more tasks than this.
    untimed: (u32, u64),
    /// Ticks that serial runs have to take before anything else is tried.
    unpaid: f64,
}

/// Serial runs between two looks at the clock.
const UNTIMED: u32 = 255;
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
            untimed: (0, 0),
            unpaid: start as f64 / PRICE,
        })
    }

    #[inline]
    pub(super) fn run<W: TreeWork>(
        &mut self,
        machine: &M,
        work: &W,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        if self.untimed.0 == 0 || self.tasks > self.untimed.1 {
            return self.timed(machine, work);
        }
        self.untimed.0 -= 1;
        let shares = self.serial.run(machine, work)?;
        self.tasks = shares[0].visited;
        Ok(shares)
    }

    fn timed<W: TreeWork>(&mut self, machine: &M, work: &W) -> Result<Vec<Share<W::Found>>, RunError> {
        let way = if self.unpaid > 0.0 { Way::Serial } else { self.choice.next(self.tasks) };
        let before = machine.now();
        let shares = match way {
            Way::Serial => self.serial.run(machine, work)?,
            Way::Shared { scheme, level } => self.shared(scheme, level, machine).run(machine, work)?,
        };
        let ticks = machine.now().saturating_sub(before);
        self.tasks = shares.iter().map(|share| share.visited).sum();
        self.choice.ran(way, self.tasks, ticks);
        if way == Way::Serial {
            self.unpaid -= ticks as f64;
            if self.unpaid <= 0.0
                && let Some(up_to) = self.choice.serial_up_to(self.tasks)
            {
                self.untimed = (UNTIMED, up_to);
                self.choice.age(UNTIMED as i32);
            }
        }
        Ok(shares)
    }

    fn shared(&mut self, scheme: usize, level: usize, machine: &M) -> &mut AnyScheme<M> {
        self.shared[scheme][level].get_or_insert_with(|| {
            AnyScheme::new(choice::SCHEMES[scheme], machine, self.levels[level], &self.settings)
                .expect("these settings were taken at the first level")
        })
    }
}
