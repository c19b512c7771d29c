//! Traces: what each processor did, under every scheme, on threads and in virtual time.

use apportion::job::synthetic::Synthetic;
use apportion::machine::simulated::Model;
use apportion::machine::{Activity, Machine, Processor, RunError, Simulated, Threads, Trace};
use apportion::scheme::SettingError;
use apportion::scheme::tree::{SCHEMES, Scheme, TreeWork};
use std::collections::BTreeMap;

fn e4000() -> Simulated {
    Simulated::new(Model::named("e4000").expect("a preset"))
}

fn scheme<M: Machine>(name: &str, machine: &M, processors: usize) -> Option<Scheme<M>> {
    match Scheme::new(name, machine, processors, BTreeMap::new()) {
        Ok(scheme) => Some(scheme),
        Err(SettingError::NativeOnly { .. }) => None,
        Err(error) => panic!("{error}"),
    }
}

fn names() -> impl Iterator<Item = &'static str> {
    SCHEMES.iter().map(|scheme| scheme.name)
}

/// Spans cover each processor's time from end to end, one after the other.
fn assert_covered(what: &str, trace: &Trace, most: usize) {
    assert!((1..=most).contains(&trace.processors.len()), "{what}: {} tracks", trace.processors.len());
    assert_eq!(trace.lost, 0, "{what}");
    for (p, spans) in trace.processors.iter().enumerate() {
        let mut now = 0;
        for span in spans {
            assert!(span.start == now && span.end > now, "{what}, processor {p}: {span:?} after {now}");
            now = span.end;
        }
        assert_eq!(now, trace.ticks, "{what}, processor {p}");
    }
}

fn spent(trace: &Trace, activity: Activity) -> u64 {
    (0..trace.processors.len()).map(|p| trace.spent(p, activity)).sum()
}

#[test]
fn every_scheme_yields_a_trace_in_virtual_time_that_changes_nothing() {
    for (name, processors) in names().flat_map(|name| [1, 2, 5, 13].map(|processors| (name, processors))) {
        let what = format!("{name}, P = {processors}");
        let (plain, traced) = (e4000(), e4000());
        let Some(mut on_plain) = scheme(name, &plain, processors) else { continue };
        let mut on_traced = scheme(name, &traced, processors).expect("as above");
        let (a, b) =
            (Synthetic::new(&plain, 401, 1000..=3000, 1), Synthetic::new(&traced, 401, 1000..=3000, 1));
        for run in 0..3 {
            assert!(traced.start_trace());
            let before = traced.now();
            let shares = on_traced.run(&traced, &b).expect("a run");
            let trace = traced.take_trace().expect("it was started");
            assert_eq!(shares, on_plain.run(&plain, &a).expect("a run"), "{what}, run {run}");
            assert_eq!((traced.now(), traced.statistics()), (plain.now(), plain.statistics()), "{what}");
            assert_covered(&what, &trace, processors);
            assert_eq!(trace.ticks, traced.now() - before, "{what}");
            assert!(trace.processors.iter().flatten().all(|span| !span.estimated), "{what}");
            // Work is what was charged, and what reading the nodes took.
            let (charged, working) = (b.cycles(), spent(&trace, Activity::Working));
            assert!((charged..charged * 5 / 4).contains(&working), "{what}: {working} of {charged} charged");
            let inside = shares.iter().enumerate().filter(|(_, share)| share.visited > 0);
            for (p, _) in inside {
                assert!(trace.spent(p, Activity::Working) > 0, "{what}: processor {p} worked");
            }
            if shares.len() > 1 {
                assert!(spent(&trace, Activity::Sending) > 0, "{what}");
                assert!(spent(&trace, Activity::Idle) + spent(&trace, Activity::Waiting) > 0, "{what}");
                assert!(spent(&trace, Activity::Barrier) > 0, "{what}");
            }
        }
        assert!(traced.take_trace().is_none(), "{what}: it was taken");
    }
}

#[test]
fn locks_are_waited_for_whatever_their_kind() {
    for (kind, _) in apportion::sync::LockKind::ALL {
        let machine = e4000();
        let work = Synthetic::new(&machine, 401, 0..=10, 1);
        let settings = BTreeMap::from([("lock".to_owned(), (*kind).to_owned())]);
        let mut scheme = Scheme::new("global_queue", &machine, 8, settings).expect("a lock");
        machine.start_trace();
        scheme.run(&machine, &work).expect("a run");
        let trace = machine.take_trace().expect("it was started");
        assert_covered(kind, &trace, 8);
        let waiting = spent(&trace, Activity::Waiting);
        assert!(
            waiting > trace.ticks,
            "{kind}: eight that crowd one queue wait: {waiting} of 8 x {}",
            trace.ticks
        );
    }
}

#[test]
fn every_scheme_yields_a_trace_on_threads() {
    // The last is more than there are cores, on most hosts.
    for processors in [1, 2, 6] {
        let team = Threads::new(processors).expect("threads");
        let work = Synthetic::new(&team, 2001, 100..=300, 1);
        for name in names() {
            let what = format!("{name}, P = {processors}");
            let mut scheme = scheme(name, &team, processors).expect("threads run all");
            for _ in 0..4 {
                assert!(team.start_trace());
                let before = team.now();
                let shares = scheme.run(&team, &work).expect("a run");
                let took = team.now() - before;
                let trace = team.take_trace().expect("it was started");
                assert_covered(&what, &trace, processors);
                // Two clocks, and another thread may get between their readings.
                assert!(trace.ticks * 101 / 100 + 1_000 > took, "{what}: {} of {took} ns", trace.ticks);
                for (p, share) in shares.iter().enumerate().filter(|(_, share)| share.visited > 50) {
                    assert!(trace.spent(p, Activity::Working) > 0, "{what}: processor {p}: {share:?}");
                }
                let working = spent(&trace, Activity::Working);
                assert!(working > 2001 * 150, "{what}: {working} ns of work");
            }
            assert!(team.take_trace().is_none(), "{what}: it was taken");
            scheme.run(&team, &work).expect("a run without a trace");
        }
    }
}

/// A tree of which a node's visit panics.
struct Rotten;

impl TreeWork for Rotten {
    type Task = u32;
    type Found = ();

    fn root(&self) -> Option<u32> {
        Some(0)
    }

    fn found(&self) {}

    fn visit<P: Processor>(&self, node: u32, (): &mut (), cpu: &P, emit: impl FnMut(u32)) {
        if node == 77 {
            std::panic::resume_unwind(Box::new("node 77 is rotten"));
        }
        cpu.charge(100);
        (2 * node + 1..=2 * node + 2).filter(|&child| child < 200).for_each(emit);
    }
}

fn outlives_a_panic<M: Machine>(machine: &M, sound: &Synthetic) {
    for name in names() {
        let Some(mut scheme) = scheme(name, machine, 3) else { continue };
        machine.start_trace();
        match scheme.run(machine, &Rotten) {
            Err(RunError::Panicked { message, .. }) => assert_eq!(message, "node 77 is rotten", "{name}"),
            other => panic!("{name}: {other:?}"),
        }
        assert_covered(name, &machine.take_trace().expect("up to the panic"), 3);
        machine.start_trace();
        scheme.run(machine, sound).expect("a run");
        let trace = machine.take_trace().expect("the machine lives on");
        assert_covered(name, &trace, 3);
        assert!(spent(&trace, Activity::Working) > 0, "{name}");
    }
}

#[test]
fn a_panic_stays_the_runs_error_and_tracing_goes_on() {
    let (team, machine) = (Threads::new(3).expect("threads"), e4000());
    outlives_a_panic(&team, &Synthetic::new(&team, 401, 20..=60, 1));
    outlives_a_panic(&machine, &Synthetic::new(&machine, 401, 20..=60, 1));
}

fn nothing_to_do<M: Machine>(machine: &M) {
    let work = Synthetic::new(machine, 0, 0..=0, 1);
    for name in names() {
        let Some(mut scheme) = scheme(name, machine, 2) else { continue };
        machine.start_trace();
        scheme.run(machine, &work).expect("a run");
        let trace = machine.take_trace().expect("it was started");
        assert_covered(name, &trace, 2);
        assert_eq!(spent(&trace, Activity::Working), 0, "{name}");
    }
}

#[test]
fn an_empty_tree_is_all_but_work() {
    nothing_to_do(&Threads::new(2).expect("threads"));
    nothing_to_do(&e4000());
}

#[test]
fn more_marks_than_there_is_room_for_are_counted() {
    let team = Threads::new(1).expect("threads");
    team.start_trace();
    team.run(1, |cpu| {
        for _ in 0..20_000 {
            cpu.during(Activity::Idle, || ());
        }
    })
    .expect("a run");
    let trace = team.take_trace().expect("it was started");
    assert!(trace.lost > 20_000, "{}", trace.lost);
    let spans = &trace.processors[0];
    assert!(spans.last().is_some_and(|last| last.end < trace.ticks), "the spans end where the marks did");
}
