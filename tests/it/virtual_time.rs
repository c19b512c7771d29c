//! Virtual times of the shipped machines, held fixed: what is added to the model must not change, by one cycle, what
//! the machines that do not have it say. A golden value changes only with a change of a preset or of a scheme that is
//! meant, and the message of the commit says so.

use apportion::machine::simulated::Model;
use apportion::machine::{Layout, Machine, Processor, Simulated, Slot, Word};
use apportion::scheme::{tiles, tree};
use apportion::sync::{Lock, LockKind};
use std::ops::Range;
use std::sync::atomic::Ordering;

/// Pieces of uneven cost.
struct Pieces;

impl tiles::TileWork for Pieces {
    type Found = ();

    fn pieces(&self) -> usize {
        777
    }

    fn found(&self) {}

    fn work_on<P: Processor>(&self, pieces: Range<usize>, _found: &mut (), cpu: &P) {
        pieces.for_each(|piece| cpu.charge(100 + piece as u64 * 31 % 300));
    }
}

/// Numbers 1 to 1,000 as a heap, of uneven cost.
struct Numbers;

impl tree::TreeWork for Numbers {
    type Task = u32;
    type Found = ();

    fn root(&self) -> Option<u32> {
        Some(1)
    }

    fn found(&self) {}

    fn visit<P: Processor>(&self, number: u32, _found: &mut (), cpu: &P, mut emit: impl FnMut(u32)) {
        cpu.charge(200 + u64::from(number) * 31 % 300);
        [2 * number, 2 * number + 1].into_iter().filter(|below| *below <= 1000).for_each(&mut emit);
    }
}

/// The machine's clock after a few accesses of every kind to lines that are fought over.
fn accesses(machine: &Simulated, processors: usize) -> u64 {
    let words = machine.alloc(40, Layout::Packed, |_| <Simulated as Machine>::Word::new(0));
    let slots = machine.alloc(3000, Layout::Padded, |i| <Simulated as Machine>::Slot::new(i as u64));
    let body = |cpu: &<Simulated as Machine>::Processor| {
        for turn in 0..200 {
            let at = cpu.id() * 7 + turn * 13;
            words[at % 40].fetch_add(1, Ordering::Relaxed);
            words[at % 17].store(turn as u64, Ordering::Relaxed);
            // SAFETY: nobody writes the slots.
            cpu.charge(unsafe { slots[at % 3000].read() } % 20);
            let _ = words[at % 11].compare_exchange(0, 1, Ordering::Relaxed, Ordering::Relaxed);
            <Simulated as Machine>::Word::fence(Ordering::SeqCst);
        }
    };
    machine.run(processors, body).expect("no panic");
    machine.now()
}

fn locks(machine: &Simulated, processors: usize) -> u64 {
    for &(_, kind) in LockKind::ALL {
        let lock = Lock::new(machine, kind, Layout::Packed, processors);
        let body = |cpu: &<Simulated as Machine>::Processor| {
            (0..20).for_each(|turn| {
                cpu.charge(37 * turn);
                lock.with(cpu, || cpu.charge(50));
            });
        };
        machine.run(processors, body).expect("no panic");
    }
    machine.now()
}

/// The schemes that were there when the values below were taken.
const TILES: [&str; 4] = ["static_blocks", "interleaved", "fixed_tiles", "decreasing_tiles"];
const TREES: [&str; 6] =
    ["global_queue", "global_counter", "hybrid", "lock_free", "receiver_initiated", "work_stealing"];

fn schemes(machine: &Simulated, processors: usize) -> u64 {
    for name in TILES {
        tiles::share(name, machine, processors, &Pieces).expect("no panic");
    }
    for name in TREES {
        tree::share(name, machine, processors, &Numbers).expect("no panic");
    }
    machine.now()
}

/// Machine, processors, and the clock after the accesses, the locks and the schemes.
const GOLDEN: &[(&str, usize, [u64; 3])] = &[
    ("e4000", 1, [25222, 58437, 3429313]),
    ("e4000", 13, [207639, 833190, 3444570]),
    ("e4000", 70, [985273, 10466420, 22461376]),
    ("pentium3x2", 2, [64846, 136680, 3060111]),
    ("host", 2, [77969, 131347, 2425602]),
    ("host", 5, [153190, 330117, 2227613]),
];

#[test]
fn shipped_machines_keep_their_times() {
    for &(name, processors, golden) in GOLDEN {
        let machine = Simulated::new(Model::named(name).expect("a preset"));
        let times =
            [accesses(&machine, processors), locks(&machine, processors), schemes(&machine, processors)];
        assert_eq!(times, golden, "{name} on {processors} processors");
    }
}
