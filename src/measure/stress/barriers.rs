//! Barriers of every kind under random numbers of processors and pauses.

use super::pause;
use crate::machine::threads::NativeSlot;
use crate::machine::{Layout, Machine, Processor, Slot, Threads};
use crate::scene::SplitMix64;
use crate::sync::{Barrier, BarrierKind};

/// Between two turns of the barrier each processor writes a number of its own, and after the second reads all of them;
/// the last one to come writes one more.
pub(super) fn barriers(team: &Threads, processors: usize, random: &mut SplitMix64) -> Result<u64, String> {
    let (name, kind) = BarrierKind::ALL[random.below(BarrierKind::ALL.len())];
    let layout = if random.below(2) == 0 { Layout::Packed } else { Layout::Padded };
    // The system's barrier takes its time.
    let most = if kind == BarrierKind::System { 10 } else { 200 };
    let (processors, turns) = (1 + random.below(processors), 1 + random.below(most) as u64);
    let barrier = Barrier::new(team, kind, layout, processors).ok_or("real threads have every kind")?;
    let numbers: Vec<NativeSlot<u64>> = (0..=processors).map(|_| NativeSlot::new(0)).collect();
    let seed = random.next_u64();
    let run = team.run(processors, |cpu| {
        let mut random = SplitMix64::new(seed ^ cpu.id() as u64);
        let mut wrong = None;
        for turn in 1..=turns {
            pause(random.next_u64());
            // SAFETY: one's own slot, which others read only between two later turns of the barrier.
            unsafe { numbers[cpu.id()].write(turn) };
            barrier.wait_then(cpu, || {
                pause(turn ^ seed);
                // SAFETY: all others wait.
                unsafe { numbers[processors].write(turn) };
            });
            for (of, number) in numbers.iter().enumerate() {
                // SAFETY: nobody writes before the next turn of the barrier.
                let found = unsafe { number.read() };
                if found != turn {
                    wrong.get_or_insert((of, found, turn));
                }
            }
            barrier.wait(cpu);
        }
        wrong
    });
    let wrong = run.map_err(|e| e.to_string())?.into_iter().flatten().next();
    match wrong {
        None => Ok(turns * processors as u64),
        Some((of, found, turn)) => {
            Err(format!("{name} of {processors}: in turn {turn}, number {of} was of turn {found}"))
        }
    }
}
