//! Sharing out the descent of a hierarchy.
//!
//! A task is a node, or whatever stands for one: a (start, stop) range of a depth-first array, a pair
//! of nodes of two trees. Visiting a task may emit tasks below it. Each task is visited exactly once,
//! by whichever processor gets it, and each processor gathers what it found; the union is the serial
//! result, whatever the scheme, the machine and the number of processors.
//!
//! On a timeline a scheme shows without doing anything for it: its visits are work, what it waits for with
//! `wait_until` is waiting, all else is sending. Where it has run dry it says so:
//! `cpu.during(Activity::Idle, || ...)`, which `sync::Quiescence` does already.
//!
//! ```
//! use apportion::machine::Threads;
//! use apportion::scheme::tree::{share, work};
//!
//! // Your own tree: node n has the children 2n and 2n + 1, up to 1000.
//! let job = work(1_u32, Vec::new, |node, found: &mut Vec<u32>, emit| {
//!     found.push(node);
//!     (2 * node..=2 * node + 1).filter(|&child| child <= 1000).for_each(emit);
//! });
//! let shares = share("lock_free", &Threads::new(2)?, 2, &job)?;
//! let mut all: Vec<u32> = shares.into_iter().flat_map(|s| s.found).collect();
//! all.sort_unstable();
//! assert!(all.iter().copied().eq(1..=1000));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod auto;
mod choice;
mod counter_queues;
mod crossbeam_deque;
mod global_counter;
mod global_queue;
mod hybrid;
mod lock_free;
mod neighbours;
mod rayon_join;
mod receiver_initiated;

mod serial;
mod work;
mod work_stealing;

pub use super::{About, Share, ShareError};
use super::{SettingError, Settings};
use crate::machine::{Machine, RunError};
pub use choice::levels as processor_levels;
use std::collections::BTreeMap;
use work::Billed;
pub use work::{Task, TreeWork, work};

/// Declares the schemes: the list is the table of contents. Each file holds a type of one name, with
/// `SUMMARY`, `NATIVE_ONLY`, `LEARNS`, `new` and `run`; the file's name is the scheme's word everywhere.
macro_rules! tree_schemes {
    ($($file:ident => $Scheme:ident),* $(,)?) => {
        enum AnyScheme<M: Machine> { $($Scheme($file::$Scheme<M>)),* }

        /// The schemes, by name.
        pub const SCHEMES: &[About] =
            &[$(About {
                name: stringify!($file),
                summary: $file::SUMMARY,
                native_only: $file::NATIVE_ONLY,
                learns: $file::LEARNS,
            }),*];

        impl<M: Machine> AnyScheme<M> {
            fn new(name: &str, machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
                match name {
                    $(stringify!($file) => {
                        Ok(AnyScheme::$Scheme($file::$Scheme::new(machine, processors, settings)?))
                    })*
                    _ => {
                        let known = SCHEMES.iter().map(|scheme| scheme.name).collect::<Vec<_>>().join(", ");
                        Err(SettingError::NoScheme { shape: "trees", name: name.to_owned(), known })
                    }
                }
            }

            fn run<W: TreeWork>(&mut self, machine: &M, work: &W) -> Result<Vec<Share<W::Found>>, RunError> {
                match self { $(AnyScheme::$Scheme(scheme) => scheme.run(machine, work)),* }
            }
        }
    };
}

tree_schemes! {
    serial => Serial,
    global_queue => GlobalQueue,
    global_counter => GlobalCounter,
    hybrid => Hybrid,
    lock_free => LockFree,
    receiver_initiated => ReceiverInitiated,
    work_stealing => WorkStealing,
    crossbeam_deque => CrossbeamDeque,
    rayon_join => RayonJoin,
    auto => Auto,
}

/// A scheme set up for a machine and a number of processors. It keeps its queues from run to run.
pub struct Scheme<M: Machine> {
    scheme: AnyScheme<M>,
    about: &'static About,
    processors: usize,
    settings: Settings,
    /// Whether the last run failed, so that tasks may be left in queues.
    spoilt: bool,
}

impl<M: Machine> Scheme<M> {
    /// Sets up the scheme called `name`.
    ///
    /// # Errors
    /// [`SettingError`]: an unknown scheme or setting, a senseless value, a machine it cannot run on.
    pub fn new(
        name: &str,
        machine: &M,
        processors: usize,
        settings: BTreeMap<String, String>,
    ) -> Result<Self, SettingError> {
        let settings = Settings::new(name, settings);
        let scheme = AnyScheme::new(name, machine, processors.max(1), &settings)?;
        settings.finish()?;
        let about = SCHEMES.iter().find(|known| known.name == name).expect("it was just made");
        Ok(Scheme { scheme, about, processors, settings, spoilt: false })
    }

    /// Shares out `work` over the processors; returns what each of them found and how many tasks it
    /// visited, in the order of their numbers.
    ///
    /// # Errors
    /// [`RunError`]. After a failed run the scheme can be used again.
    pub fn run<W: TreeWork>(&mut self, machine: &M, work: &W) -> Result<Vec<Share<W::Found>>, RunError> {
        machine.check_processors(self.processors)?;
        if self.spoilt {
            self.scheme = AnyScheme::new(self.about.name, machine, self.processors, &self.settings)
                .expect("these settings have been used before");
        }
        self.spoilt = true;
        let shares = self.scheme.run(machine, &Billed(work))?;
        self.spoilt = false;
        Ok(shares)
    }

    /// The scheme's line in the list of schemes.
    pub fn about(&self) -> &'static About {
        self.about
    }
}

/// Shares out `work` once, under the scheme called `name` with its default settings. To do it every
/// frame, keep a [`Scheme`].
///
/// # Errors
/// [`ShareError`].
pub fn share<M: Machine, W: TreeWork>(
    name: &str,
    machine: &M,
    processors: usize,
    work: &W,
) -> Result<Vec<Share<W::Found>>, ShareError> {
    Ok(Scheme::new(name, machine, processors, BTreeMap::new())?.run(machine, work)?)
}
