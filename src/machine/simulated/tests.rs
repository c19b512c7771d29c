use super::*;
use crate::machine::Monitor;

fn e4000() -> Simulated {
    Simulated::new(Model::named("e4000").unwrap())
}

#[test]
fn accesses_happen_in_the_order_of_virtual_time() {
    let machine = e4000();
    let log = Mutex::new(Vec::new());
    let words = machine.alloc(4, Layout::Padded, |_| SimulatedWord::new(0));
    machine
        .run(4, |cpu| {
            // The later a processor's number, the earlier it gets to its access.
            cpu.charge(100_000 - 20_000 * cpu.id as u64);
            words[cpu.id].load(Ordering::Relaxed);
            log.lock().unwrap().push(cpu.id);
        })
        .unwrap();
    assert_eq!(*log.lock().unwrap(), [3, 2, 1, 0]);
}

#[test]
fn a_run_is_the_same_every_time_and_a_disturbed_one_by_its_seed() {
    let trace = |machine: Simulated| {
        let words = machine.alloc(3, Layout::Packed, |_| SimulatedWord::new(0));
        let order = machine
            .run(7, |cpu| {
                let drawn: Vec<u64> = (0..50)
                    .map(|i| {
                        cpu.charge(10 * (cpu.id as u64 + i) % 37);
                        words[i as usize % 3].fetch_add(1, Ordering::Relaxed)
                    })
                    .collect();
                drawn
            })
            .unwrap();
        (order, machine.now(), machine.statistics())
    };
    assert_eq!(trace(e4000()), trace(e4000()));
    assert_eq!(trace(e4000().disturbed(3)), trace(e4000().disturbed(3)));
    assert_ne!(trace(e4000().disturbed(3)).0, trace(e4000().disturbed(4)).0);
}

#[test]
fn sleepers_wake_on_a_write_and_a_deadlock_is_reported() {
    let machine = e4000();
    let word = machine.alloc(1, Layout::Packed, |_| SimulatedWord::new(0));
    let seen = machine
        .run(3, |cpu| {
            if cpu.id == 2 {
                cpu.charge(5_000);
                word[0].store(7, Ordering::Release);
            }
            cpu.wait_until(&[&word[0]], || word[0].load(Ordering::Acquire) == 7);
            word[0].load(Ordering::Relaxed)
        })
        .unwrap();
    assert_eq!(seen, [7, 7, 7]);
    assert!(machine.now() >= 5_000);
    let stuck = machine.run(3, |cpu| {
        if cpu.id > 0 {
            cpu.wait_until(&[&word[0]], || word[0].load(Ordering::Acquire) == 8);
        }
    });
    // Processor 0 waits for the other two to finish.
    assert!(
        matches!(&stuck, Err(RunError::Deadlock { waiting, finished: 0 }) if *waiting == [0, 1, 2]),
        "{stuck:?}"
    );
    assert!(machine.run(3, |_| ()).is_ok(), "the machine can be used after a failed run");
}

#[test]
fn a_panic_unwinds_all_and_is_reported() {
    let machine = e4000();
    let word = machine.alloc(1, Layout::Packed, |_| SimulatedWord::new(0));
    let held = Arc::new(());
    let result = machine.run(5, |cpu| {
        let _kept = held.clone();
        assert!(cpu.id != 3, "number {}", cpu.id);
        cpu.wait_until(&[&word[0]], || word[0].load(Ordering::Acquire) == 9);
    });
    match result {
        Err(RunError::Panicked { processor: 3, message }) => assert_eq!(message, "number 3"),
        other => panic!("{other:?}"),
    }
    assert_eq!(Arc::strong_count(&held), 1, "every stack was unwound");
}

#[test]
fn numbers_of_processors_are_checked_and_large_ones_work() {
    let machine = e4000();
    assert!(machine.run(0, |_| ()).is_err());
    assert!(machine.run(10_000, |_| ()).is_err());
    let words = machine.alloc(1, Layout::Packed, |_| SimulatedWord::new(0));
    machine.run(1024, |_| words[0].fetch_add(1, Ordering::Relaxed)).unwrap();
    assert_eq!(words[0].load(Ordering::Relaxed), 1024);
    let nested = machine.run(1, |_| machine.run(1, |_| ()).is_err()).unwrap();
    assert_eq!(nested, [true]);
}

#[test]
fn a_counter_at_memory_is_not_handed_from_cache_to_cache() {
    let time = |at_memory: u64| {
        let mut model = Model::named("origin2000").unwrap();
        model.network.at_memory = at_memory;
        let machine = Simulated::new(model);
        let word = machine.alloc(1, Layout::Padded, |_| SimulatedWord::new(0));
        let drawn = machine.run(64, |_| word[0].fetch_add_at_memory(1, Ordering::Relaxed)).unwrap();
        let mut drawn = drawn;
        drawn.sort_unstable();
        assert!(drawn.into_iter().eq(0..64));
        machine.now()
    };
    assert!(time(32) < time(0), "{} {}", time(32), time(0));
}

#[test]
fn sleepers_are_woken_one_after_the_other() {
    let model = Model::named("origin2000").unwrap();
    let wake = model.wake;
    let machine = Simulated::new(model);
    let monitor = machine.monitor().expect("its time to wake is known");
    for _ in 0..2 {
        let clocks = machine
            .run(5, |cpu| {
                cpu.charge(10_000 * cpu.id as u64);
                monitor.pass(cpu, |come| come + 1, |_, come| come == 5);
                engine::with(|engine| engine.clocks[cpu.id]).unwrap()
            })
            .unwrap();
        // Processor 4 comes last and goes at once; 0 fell asleep first.
        for sleeper in 0..4 {
            let late = clocks[sleeper] - clocks[4];
            let expected = wake * (sleeper as u64 + 1);
            assert!(late.abs_diff(expected) < 2000, "{sleeper}: {late} cycles late, {expected} expected");
        }
        monitor.reset();
    }
    assert!(e4000().monitor().is_none(), "nobody has said how long it takes there");
}
