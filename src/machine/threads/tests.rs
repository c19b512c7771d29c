use super::*;
use crate::machine::Word;

#[test]
fn everyone_runs_once_and_answers_in_order() {
    let team = Threads::new(4).unwrap();
    for processors in [1, 2, 4, 3] {
        let ids = team.run(processors, |cpu| (cpu.id(), cpu.count())).unwrap();
        assert_eq!(ids, (0..processors).map(|p| (p, processors)).collect::<Vec<_>>());
    }
}

#[test]
fn a_panic_ends_the_run_as_an_error_and_the_team_lives_on() {
    let team = Threads::new(3).unwrap();
    let word = NativeWord::new(0);
    for culprit in 0..3 {
        let result = team.run(3, |cpu| {
            assert!(cpu.id() != culprit, "culprit {culprit}");
            // The others wait for what will never come.
            cpu.wait_until(&[&word], || word.load(Ordering::Relaxed) == 1);
        });
        match result {
            Err(RunError::Panicked { processor, message }) => {
                assert_eq!((processor, message), (culprit, format!("culprit {culprit}")));
            }
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(team.run(3, |cpu| cpu.id()).unwrap().len(), 3);
}

#[test]
fn parked_helpers_are_woken() {
    let settings = TeamSettings { spin: Duration::ZERO, ..TeamSettings::default() };
    let team = Threads::with_settings(2, &settings).unwrap();
    for _ in 0..50 {
        while !team.is_parked(2) {
            std::thread::yield_now();
        }
        assert_eq!(team.run(2, |cpu| cpu.id()).unwrap(), [0, 1]);
    }
}

#[test]
fn wrong_numbers_and_nesting_are_refused() {
    assert!(matches!(Threads::new(0), Err(RunError::Processors { asked: 0, .. })));
    assert!(matches!(Threads::new(10_000), Err(RunError::Processors { .. })));
    let team = Threads::new(2).unwrap();
    assert!(matches!(team.run(3, |_| ()), Err(RunError::Processors { asked: 3, most: 2, .. })));
    let nested = team.run(1, |_| team.run(1, |_| ()).is_err()).unwrap();
    assert_eq!(nested, [true]);
}

#[test]
fn a_team_started_from_a_pinned_thread_has_the_other_cores_too() {
    let cores = Threads::cores();
    // On a thread of its own, which stays pinned.
    let seen = std::thread::spawn(|| {
        let settings = TeamSettings { pin_caller: true, ..TeamSettings::default() };
        let _first = Threads::with_settings(1, &settings).unwrap();
        let second = Threads::with_settings(2, &settings).unwrap();
        second.run(2, |_| core_affinity::get_core_ids()).unwrap()
    });
    let seen = seen.join().unwrap();
    if let [Some(caller), Some(helper)] = &seen[..]
        && cores > 1
    {
        assert_ne!(caller, helper, "both were pinned to one core");
    }
    assert_eq!(Threads::cores(), cores);
}
