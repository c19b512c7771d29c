//! The primitives by themselves.

use super::pause;
use crate::machine::threads::{NativeSlot, NativeWord, Thread};
use crate::machine::{Layout, Machine, Processor, Seats, Slot, Threads, Word};
use crate::scene::SplitMix64;
use crate::sync::{self, Lock, LockKind, Quiescence, Receiver, RingSettings, Sender};
use std::sync::atomic::Ordering;

/// A check: on a team, on up to so many processors, as the generator says; what it did, or what was wrong.
pub(super) type Check = fn(&Threads, usize, &mut SplitMix64) -> Result<u64, String>;

fn ring(random: &mut SplitMix64) -> RingSettings {
    RingSettings {
        capacity: 1 + random.below(5),
        layout: if random.below(2) == 0 { Layout::Packed } else { Layout::Padded },
        remember_index: random.below(2) == 0,
    }
}

/// A generator for each processor of a run.
fn own(random: &mut SplitMix64) -> impl Fn(&Thread) -> SplitMix64 + use<> {
    let seed = random.next_u64();
    move |cpu| SplitMix64::new(seed ^ cpu.id() as u64)
}

/// Processor 0 sends numbers, processor 1 receives them: all, once, in order.
pub(super) fn in_queue(team: &Threads, _processors: usize, random: &mut SplitMix64) -> Result<u64, String> {
    let (tasks, settings, own) = (1 + random.below(2000) as u64, ring(random), own(random));
    let (to, from) = sync::in_queue(team, settings);
    let mut ends = [(Some(to), None), (None, Some(from))].into_iter();
    let seats = Seats::new(team, 2, |_| ends.next().expect("two ends"));
    let run = team.run(2, |cpu| {
        let mut random = own(cpu);
        match &mut *seats.claim(cpu) {
            (Some(to), _) => send(to, tasks, cpu, &mut random),
            (_, Some(from)) => receive(from, tasks, cpu, &mut random),
            (None, None) => Ok(()),
        }
    });
    let ends = run.map_err(|e| e.to_string())?;
    ends.into_iter().collect::<Result<(), String>>().map_err(|e| format!("{e} ({settings:?})"))?;
    Ok(tasks)
}

fn send(to: &mut Sender<Threads>, tasks: u64, cpu: &Thread, random: &mut SplitMix64) -> Result<(), String> {
    let mut next = 0;
    while next < tasks {
        let number = random.next_u64();
        pause(number);
        let sent = if number & 1 << 40 == 0 {
            u64::from(to.push(next))
        } else {
            let chunk: Vec<u64> = (next..tasks.min(next + 1 + (number >> 50))).collect();
            to.push_all(&chunk) as u64
        };
        if sent == 0 {
            cpu.spin();
        }
        next += sent;
    }
    Ok(())
}

fn receive(
    from: &mut Receiver<Threads>,
    tasks: u64,
    cpu: &Thread,
    random: &mut SplitMix64,
) -> Result<(), String> {
    let (mut next, mut got) = (0, Vec::new());
    while next < tasks {
        let number = random.next_u64();
        pause(number);
        if number & 1 << 40 == 0 {
            got.extend(from.pop());
        } else {
            from.pop_all(&mut got);
        }
        for task in got.drain(..) {
            if task != next {
                return Err(format!("task {task} came in the place of {next}"));
            }
            next += 1;
        }
        cpu.wait_until(&[from.arrivals()], || next == tasks || from.has_arrivals() || !from.is_empty());
    }
    if from.look() == 0 { Ok(()) } else { Err("more tasks came than were sent".to_owned()) }
}

/// All add to a plain number under a lock.
pub(super) fn lock(team: &Threads, processors: usize, random: &mut SplitMix64) -> Result<u64, String> {
    let (name, kind) = LockKind::ALL[random.below(LockKind::ALL.len())];
    let (processors, turns) = (1 + random.below(processors), 1 + random.below(300) as u64);
    let (lock, own) = (Lock::new(team, kind, Layout::Packed, processors), own(random));
    let number = NativeSlot::new(0);
    let run = team.run(processors, |cpu| {
        let mut random = own(cpu);
        for _ in 0..turns {
            lock.with(cpu, || {
                // SAFETY: the lock is held.
                let before = unsafe { number.read() };
                pause(random.next_u64());
                // SAFETY: as above.
                unsafe { number.write(before + 1) };
            });
            pause(random.next_u64());
        }
    });
    run.map_err(|e| e.to_string())?;
    // SAFETY: the run is over.
    let (found, expected) = (unsafe { number.read() }, turns * processors as u64);
    if found == expected { Ok(found) } else { Err(format!("{name}: {found} of {expected} turns counted")) }
}

/// A processor's ends of rings.
#[derive(Default)]
struct Links {
    to: Vec<Sender<Threads>>,
    from: Vec<Receiver<Threads>>,
}

/// Tasks travel round in random numbers of hops; nobody may be told that all is over before the last.
pub(super) fn quiescence(team: &Threads, processors: usize, random: &mut SplitMix64) -> Result<u64, String> {
    let processors = 1 + random.below(processors);
    let mut links: Vec<Links> = (0..processors).map(|_| Links::default()).collect();
    for p in 0..processors {
        let steps = if processors > 2 { 1..3 } else { 1..2 };
        for step in steps {
            let (to, from) = sync::in_queue(team, ring(random));
            links[p].to.push(to);
            links[(p + step) % processors].from.push(from);
        }
    }
    let tasks: Vec<u64> = (0..random.below(20)).map(|_| 1 + random.below(30) as u64).collect();
    let (hops, own) = (tasks.iter().sum::<u64>(), own(random));
    let mut links = links.into_iter();
    let seats = Seats::new(team, processors, |_| links.next().expect("one a processor"));
    let quiescence = Quiescence::new(team, processors);
    quiescence.reset();
    let handled = team.alloc(1, Layout::Padded, |_| NativeWord::new(0));
    let run = team.run(processors, |cpu| {
        let (mut random, mut sent, mut received) = (own(cpu), 0, 0);
        let mut local = if cpu.id() == 0 { tasks.clone() } else { Vec::new() };
        let mut seat = seats.claim(cpu);
        let Links { to, from } = &mut *seat;
        loop {
            let task = local.pop().or_else(|| {
                let task = from.iter_mut().find_map(Receiver::pop);
                received += u64::from(task.is_some());
                task
            });
            if let Some(task) = task {
                pause(random.next_u64());
                // ORDERING: Relaxed: that it comes before the end of the run is what is checked.
                handled[0].fetch_add(1, Ordering::Relaxed);
                if task > 1 {
                    let turn = random.below(to.len());
                    if to[turn].push(task - 1) {
                        sent += 1;
                    } else {
                        local.push(task - 1);
                    }
                }
                continue;
            }
            let arrivals: Vec<_> = from.iter().map(Receiver::arrivals).collect();
            let has_work = || from.iter().any(Receiver::has_arrivals);
            if quiescence.wait(cpu, sent, received, &arrivals, has_work) {
                // ORDERING: Relaxed, as above.
                return handled[0].load(Ordering::Relaxed);
            }
        }
    });
    let seen = run.map_err(|e| e.to_string())?;
    match seen.iter().position(|&seen| seen != hops) {
        Some(p) => Err(format!("processor {p} of {processors} stopped after {} of {hops} hops", seen[p])),
        None => Ok(hops),
    }
}
