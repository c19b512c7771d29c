//! Chooses between one processor and sharing by what was measured on this very work: "model no more than
//! a scene needs", and one processor is a good answer.
//!
//! Steps: 1. a serial run is timed; 2. if starting a run on the machine as it is now (its team may
//! sleep) takes less than 2 % of the time until the next look, three runs are shared, the best of which
//! counts; 3. the faster way is kept. While serial, the next look comes after 64 runs, then 128, up to
//! 4,096, and the runs between are not even timed: they cost a counter and a branch. While sharing, every run is timed, and every
//! 256th is serial, since scenes change and teams fall asleep.
//!
//! Settings: those of `lock_free`, which does the sharing.

use super::lock_free::LockFree;
use super::serial::Serial;
use super::{Share, TreeWork};
use crate::machine::{Machine, RunError};
use crate::scheme::{SettingError, Settings};

pub(super) const SUMMARY: &str = "one processor or lock_free, whichever has proved faster";
pub(super) const NATIVE_ONLY: bool = false;

pub(super) struct Auto<M: Machine> {
    serial: Serial<M>,
    shared: LockFree<M>,
    processors: usize,
    mode: Mode,
    /// Smoothed ticks of a serial run.
    serial_ticks: f64,
    /// Serial runs between looks.
    interval: u32,
}

enum Mode {
    /// Serial, with so many runs until the next look.
    Serial { left: u32 },
    /// Shared runs on trial: how many are left, and the best ticks so far.
    Trial { left: u32, best: f64 },
    /// Sharing: runs until the next serial one, and smoothed ticks of a shared run.
    Sharing { left: u32, ticks: f64 },
}

const FIRST_INTERVAL: u32 = 64;
const LAST_INTERVAL: u32 = 4096;
const TRIALS: u32 = 3;
const SERIAL_EVERY: u32 = 256;
/// What a look may cost, as a part of the serial runs until the next one.
const PRICE_OF_A_LOOK: f64 = 0.02;

impl<M: Machine> Auto<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        Ok(Auto {
            serial: Serial::new(machine, 1, settings)?,
            shared: LockFree::new(machine, processors, settings)?,
            processors,
            mode: Mode::Serial { left: 0 },
            serial_ticks: 0.0,
            interval: FIRST_INTERVAL,
        })
    }

    #[inline]
    pub(super) fn run<W: TreeWork>(
        &mut self,
        machine: &M,
        work: &W,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        if let Mode::Serial { left } = &mut self.mode
            && *left > 0
        {
            *left -= 1;
            return self.serial.run(machine, work);
        }
        self.timed(machine, work)
    }

    fn timed<W: TreeWork>(&mut self, machine: &M, work: &W) -> Result<Vec<Share<W::Found>>, RunError> {
        let serial = match self.mode {
            Mode::Serial { .. } => true,
            Mode::Trial { .. } => false,
            Mode::Sharing { left, .. } => left == 0,
        };
        let before = machine.now();
        let shares = if serial { self.serial.run(machine, work)? } else { self.shared.run(machine, work)? };
        let ticks = machine.now().saturating_sub(before) as f64;
        if serial {
            let old = self.serial_ticks;
            self.serial_ticks = if old == 0.0 { ticks } else { 0.5 * (old + ticks) };
        }
        self.mode = match self.mode {
            Mode::Serial { .. } if self.is_worth_a_trial(machine) => {
                Mode::Trial { left: TRIALS, best: f64::INFINITY }
            }
            Mode::Serial { .. } => self.stay_serial(),
            Mode::Trial { left, best } => {
                let (left, best) = (left - 1, best.min(ticks));
                if left > 0 {
                    Mode::Trial { left, best }
                } else if best < self.serial_ticks {
                    self.interval = FIRST_INTERVAL;
                    Mode::Sharing { left: SERIAL_EVERY, ticks: best }
                } else {
                    self.stay_serial()
                }
            }
            Mode::Sharing { ticks: shared, .. } if serial => {
                Mode::Sharing { left: SERIAL_EVERY, ticks: shared }
            }
            Mode::Sharing { left, ticks: shared } => {
                let shared = 0.75 * shared + 0.25 * ticks;
                if shared < self.serial_ticks {
                    Mode::Sharing { left: left - 1, ticks: shared }
                } else {
                    self.stay_serial()
                }
            }
        };
        Ok(shares)
    }

    /// Whether waking a team that sleeps costs little beside the runs until the next look. That a team
    /// once woken stays awake, where runs follow closely, only a trial shows.
    fn is_worth_a_trial(&self, machine: &M) -> bool {
        let until_next_look = self.serial_ticks * f64::from(self.interval);
        let start = machine.start_ticks(self.processors) as f64;
        self.processors > 1 && start < PRICE_OF_A_LOOK * until_next_look
    }

    fn stay_serial(&mut self) -> Mode {
        let left = self.interval;
        self.interval = (2 * left).min(LAST_INTERVAL);
        Mode::Serial { left }
    }
}
