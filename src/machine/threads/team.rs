//! The persistent team behind [`Threads`](super::Threads).
//!
//! Protocol of a run: 1. the caller writes the job, then posts its number to each helper that takes
//! part ([`Handoff::post`]); 2. all run the body; 3. each helper writes the number into its `done`
//! word; 4. the caller waits for all of them before it returns, whatever happened, so the borrowed
//! body outlives its users.

use super::track::Tracks;
use super::{MOST, NativeWord, TeamSettings, Thread, now};
use crate::machine::handoff::Handoff;
use crate::machine::{Activity, Ended, RunError, Word, panic_message};
use core_affinity::CoreId;
use crossbeam::utils::CachePadded;
use std::any::Any;
use std::cell::UnsafeCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

/// The body of a run, its lifetime erased: `Team::run` keeps it alive until all are done.
type Body = *const (dyn Fn(&Thread) + Sync);

struct Common {
    helpers: Vec<CachePadded<Helper>>,
    ended: Arc<AtomicBool>,
    failure: Mutex<Option<(usize, String)>>,
    spin: Duration,
    patience: u32,
    tracks: Tracks,
}

#[derive(Clone, Copy)]
struct Job {
    body: Body,
    processors: usize,
    /// Told here, so that a helper looks at nothing else to know.
    traced: bool,
}

#[derive(Default)]
#[repr(C, align(64))]
struct Helper {
    handoff: Handoff<NativeWord>,
    /// What to run, in the very line whose change tells of it: one transfer instead of two.
    job: UnsafeCell<Option<Job>>,
    done: CachePadded<Done>,
}

struct Done(NativeWord);

impl Default for Done {
    fn default() -> Self {
        Done(NativeWord::new(0))
    }
}

// SAFETY: `job` is written by the caller only while no helper runs (it holds `running` and waits for
// every helper of the run before), and read by helpers after the post that follows the write. The
// body it points to is Sync.
unsafe impl Sync for Common {}
// SAFETY: as above; the pointer is only followed during the run that set it.
unsafe impl Send for Common {}

/// The number of a post that tells a helper to leave.
const LEAVE: u64 = u64::MAX;

pub(super) struct Team {
    common: Arc<Common>,
    threads: Vec<JoinHandle<()>>,
    running: AtomicBool,
    caller: Mutex<Caller>,
}

/// What the calling thread keeps from run to run.
struct Caller {
    /// Number of the last run.
    epoch: u64,
    thread: Thread,
}

impl Team {
    pub(super) fn start(processors: usize, settings: &TeamSettings) -> Result<Self, RunError> {
        debug_assert!((1..=MOST).contains(&processors));
        let cores: &[CoreId] = if settings.pin { super::cores() } else { &[] };
        // With a core each, a waiting worker may spin long; with fewer cores it must step aside soon.
        let patience = if processors <= super::Threads::cores() { 1 << 14 } else { 64 };
        let common = Arc::new(Common {
            helpers: (1..processors).map(|_| CachePadded::default()).collect(),
            ended: Arc::new(AtomicBool::new(false)),
            failure: Mutex::new(None),
            spin: settings.spin,
            patience,
            tracks: Tracks::default(),
        });
        if settings.pin_caller
            && let Some(&core) = cores.first()
        {
            core_affinity::set_for_current(core);
        }
        let caller = Mutex::new(Caller { epoch: 0, thread: common.thread(0) });
        let mut team = Team { common, threads: Vec::new(), running: AtomicBool::new(false), caller };
        for id in 1..processors {
            let (common, count) = (team.common.clone(), cores.len());
            let core = (count > 0).then(|| cores[id % count]);
            let spawned = std::thread::Builder::new().name(format!("apportion-{id}")).spawn(move || {
                if let Some(core) = core {
                    // Pinning is a wish: where the system refuses, the thread runs unpinned.
                    core_affinity::set_for_current(core);
                }
                work(&common, id);
            });
            match spawned {
                Ok(thread) => team.threads.push(thread),
                Err(source) => return Err(RunError::System { what: "a thread", source }),
            }
        }
        Ok(team)
    }

    pub(super) fn processors(&self) -> usize {
        self.common.helpers.len() + 1
    }

    pub(super) fn is_parked(&self, processors: usize) -> bool {
        self.common.helpers.iter().take(processors - 1).any(|h| h.handoff.is_parked())
    }

    pub(super) fn tracks(&self) -> &Tracks {
        &self.common.tracks
    }

    /// Runs `body` on processors `0 .. processors`, the caller being 0.
    pub(super) fn run(&self, processors: usize, body: &(dyn Fn(&Thread) + Sync)) -> Result<(), RunError> {
        // ORDERING: Acquire pairs with the Release below: one run's writes precede the next one's.
        if self.running.swap(true, Ordering::Acquire) {
            return Err(RunError::Busy("threads".to_owned()));
        }
        let mut caller = self.caller.lock().unwrap_or_else(|e| e.into_inner());
        let Caller { epoch, thread: me } = &mut *caller;
        *epoch += 1;
        me.count = processors;
        let common = &*self.common;
        // SAFETY: this only erases the lifetime; the loop below waits for every helper before `body`
        // goes out of scope.
        let erased: Body = unsafe {
            std::mem::transmute::<*const (dyn Fn(&Thread) + Sync + '_), Body>(std::ptr::from_ref(body))
        };
        let traced = common.tracks.are_on();
        let job = Job { body: erased, processors, traced };
        for (helper, thread) in common.helpers.iter().zip(&self.threads).take(processors - 1) {
            // SAFETY: no helper runs now (see `Common`), so nobody reads the job.
            unsafe { *helper.job.get() = Some(job) };
            helper.handoff.post(*epoch, || thread.thread().unpark());
        }
        if traced {
            me.follow(common.tracks.lend(0, Activity::Sending));
        }
        let outcome = catch_unwind(AssertUnwindSafe(|| body(me)));
        if traced {
            me.follow(None);
        }
        if let Err(payload) = outcome {
            common.fail(0, &*payload);
        }
        let mut turns = 0;
        for helper in common.helpers.iter().take(processors - 1) {
            // ORDERING: Acquire pairs with the helper's Release store of `done`.
            while helper.done.0.load(Ordering::Acquire) != *epoch {
                turns += 1;
                if turns % common.patience == 0 {
                    std::thread::yield_now();
                } else {
                    std::hint::spin_loop();
                }
            }
        }
        let failure = common.failure.lock().unwrap_or_else(|e| e.into_inner()).take();
        // ORDERING: Relaxed: the helpers are done, and the next run's posts publish it. Written only if
        // need be: the helpers hold copies of its line.
        if common.ended.load(Ordering::Relaxed) {
            common.ended.store(false, Ordering::Relaxed);
        }
        drop(caller);
        // ORDERING: Release pairs with the Acquire above.
        self.running.store(false, Ordering::Release);
        match failure {
            Some((processor, message)) => Err(RunError::Panicked { processor, message }),
            None => Ok(()),
        }
    }
}

impl Drop for Team {
    fn drop(&mut self) {
        for (helper, thread) in self.common.helpers.iter().zip(&self.threads) {
            helper.handoff.post(LEAVE, || thread.thread().unpark());
        }
        for thread in self.threads.drain(..) {
            // A helper catches every panic of a body, so it leaves by returning.
            let _ = thread.join();
        }
    }
}

impl Common {
    /// The handle of processor `id`, made once: counting references every run would move a line.
    fn thread(&self, id: usize) -> Thread {
        Thread::new(id, 1, self.patience, Some(Arc::clone(&self.ended)))
    }

    /// Notes the first real panic and tells the others to end.
    fn fail(&self, processor: usize, payload: &(dyn Any + Send)) {
        if !payload.is::<Ended>() {
            let mut failure = self.failure.lock().unwrap_or_else(|e| e.into_inner());
            failure.get_or_insert_with(|| (processor, panic_message(payload)));
        }
        // ORDERING: Relaxed: the flag carries no data.
        self.ended.store(true, Ordering::Relaxed);
    }
}

/// A helper's life.
fn work(common: &Common, id: usize) {
    let helper = &common.helpers[id - 1];
    let mut me = common.thread(id);
    let mut seen = 0;
    loop {
        let mut turns = 0u32;
        let mut since = None;
        seen = helper.handoff.wait(
            seen,
            || {
                std::hint::spin_loop();
                turns += 1;
                if turns.is_multiple_of(common.patience) {
                    std::thread::yield_now();
                }
                // Reading the clock costs tens of nanoseconds, so only now and then.
                !turns.is_multiple_of(64) || since.get_or_insert_with(now).elapsed() < common.spin
            },
            std::thread::park,
        );
        if seen == LEAVE {
            return;
        }
        // SAFETY: the post that was just received follows the write of the job (Release, Acquire).
        let job = unsafe { *helper.job.get() }.expect("a post follows its job");
        me.count = job.processors;
        if job.traced {
            me.follow(common.tracks.lend(id, Activity::Sending));
        }
        // SAFETY: the caller keeps the body alive until `done` is written.
        let outcome = catch_unwind(AssertUnwindSafe(|| unsafe { (*job.body)(&me) }));
        if job.traced {
            me.follow(None);
        }
        if let Err(payload) = outcome {
            common.fail(id, &*payload);
        }
        // ORDERING: Release pairs with the caller's Acquire load in `Team::run`.
        helper.done.0.store(seen, Ordering::Release);
    }
}
