//! What the processors of a machine did while a frame ran: marks made on the way, spans drawn from them.
//!
//! A mark is a time and what the processor does from then on, so spans can neither overlap nor leave gaps.
//! [`Machine::start_trace`](super::Machine::start_trace) notes the time; schemes, locks and machines mark
//! changes ([`Processor::enter`](super::Processor::enter)); [`Machine::take_trace`](super::Machine::take_trace)
//! notes the time and makes spans of the marks. What lies before a processor's first mark and after its last
//! is [`Activity::Barrier`]; one that took part in no run was [`Activity::Idle`].
//!
//! A processor has room for a fixed number of marks. Those that find none are counted ([`Trace::lost`]) and
//! its spans end there.

/// What a processor spends its time on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Activity {
    /// The job's own work: visiting tasks.
    Working,
    /// The scheme's work: handing tasks over, and finding the next.
    Sending,
    /// Waiting for another processor that will be done soon: for a lock, for an answer.
    Waiting,
    /// Nothing to do: waiting for work, or for word that there is none left.
    Idle,
    /// The start and the end of a run: waiting to be let in, or until all are through.
    Barrier,
}

impl Activity {
    /// All there are.
    pub const ALL: [Activity; 5] =
        [Activity::Working, Activity::Sending, Activity::Waiting, Activity::Idle, Activity::Barrier];

    /// Its word in files and legends.
    pub fn name(self) -> &'static str {
        match self {
            Activity::Working => "working",
            Activity::Sending => "sending",
            Activity::Waiting => "waiting",
            Activity::Idle => "idle",
            Activity::Barrier => "barrier",
        }
    }
}

/// A stretch of time that a processor spent on one thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// On what.
    pub activity: Activity,
    /// From when, in ticks of the machine's clock since the trace was started.
    pub start: u64,
    /// Until when, in the same ticks; greater than `start`.
    pub end: u64,
    /// Whether how long it took was told from tasks looked into nearby (see
    /// [`Processor::take_up`](super::Processor::take_up)): it was between two marks, in this proportion.
    pub estimated: bool,
}

/// What each processor did from the start of a trace until it was taken.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Trace {
    /// The spans of each processor, in order. Without lost marks they cover `0 .. ticks`.
    pub processors: Vec<Vec<Span>>,
    /// How long it lasted, in ticks of the machine's clock.
    pub ticks: u64,
    /// Marks for which there was no room.
    pub lost: u64,
}

impl Trace {
    /// Ticks that a processor spent on an activity.
    ///
    /// # Panics
    /// If there is no such processor.
    pub fn spent(&self, processor: usize, activity: Activity) -> u64 {
        let spans = self.processors[processor].iter().filter(|span| span.activity == activity);
        spans.map(|span| span.end - span.start).sum()
    }
}

/// A mark: from when on, and what; `None` for tasks that were not looked into.
type Mark = (u64, Option<Activity>);

/// The marks of one processor.
#[derive(Debug)]
pub(super) struct Marks {
    marks: Vec<Mark>,
    room: usize,
    /// What is being done, as the last mark said, lost or not; none before the first.
    now: Option<Option<Activity>>,
    /// When the first mark was lost.
    full_at: u64,
    lost: u64,
}

/// How the clock of the marks is read.
pub(super) struct Reading<F> {
    /// Ticks of the machine's clock since the trace was started; it never goes down.
    pub(super) ticks: F,
    /// When the trace was taken, in those ticks.
    pub(super) end: u64,
    /// What a look at the clock takes, in those ticks.
    pub(super) look: u64,
}

impl Marks {
    /// No marks, and room for so many; memory is taken as it is needed.
    pub(super) fn new(room: usize) -> Self {
        Marks { marks: Vec::new(), room, now: None, full_at: 0, lost: 0 }
    }

    /// Takes the memory for all the room there is, and touches it, so that no page is missing later.
    pub(super) fn with_memory(mut self) -> Self {
        self.marks.resize(self.room, (0, None));
        self.marks.clear();
        self
    }

    /// What is being done; none before the first mark and while tasks are not looked into.
    pub(super) fn now(&self) -> Option<Activity> {
        self.now.flatten()
    }

    /// Marks a change at a time that is no earlier than the mark before.
    #[inline]
    pub(super) fn mark(&mut self, at: u64, activity: Option<Activity>) {
        if self.now == Some(activity) {
            return;
        }
        self.now = Some(activity);
        if self.marks.len() < self.room {
            self.marks.push((at, activity));
            return;
        }
        if self.lost == 0 {
            self.full_at = at;
        }
        self.lost += 1;
    }

    /// How many marks found no room.
    pub(super) fn lost(&self) -> u64 {
        self.lost
    }

    /// Forgets all marks and keeps the memory.
    pub(super) fn clear(&mut self) {
        self.marks.clear();
        (self.now, self.lost) = (None, 0);
    }

    /// The spans between the start of the trace and its end.
    pub(super) fn spans(&self, reading: &Reading<impl Fn(u64) -> u64>) -> Vec<Span> {
        if self.marks.is_empty() {
            let idle = Span { activity: Activity::Idle, start: 0, end: reading.end, estimated: false };
            return (reading.end > 0).then_some(idle).into_iter().collect();
        }
        let ends_at = if self.lost > 0 { (reading.ticks)(self.full_at) } else { reading.end };
        let times = self.marks.iter().map(|&(at, _)| (reading.ticks)(at)).chain([ends_at]);
        let times: Vec<u64> = times.map(|at| at.min(reading.end)).collect();
        let share = self.working_share(&times, reading.look);
        let mut spans = Spans::default();
        spans.add(Activity::Barrier, 0, times[0], false);
        for (&(_, activity), time) in self.marks.iter().zip(times.windows(2)) {
            let (start, end) = (time[0], time[1]);
            match activity {
                Some(activity) => spans.add(activity, start, end, false),
                None => {
                    let middle = start + ((end - start) as f64 * share).round() as u64;
                    spans.add(Activity::Working, start, middle, true);
                    spans.add(Activity::Sending, middle, end, true);
                }
            }
        }
        spans.0
    }

    /// The share of a task's time that is the job's own, from the tasks looked into; each span there holds one
    /// look at the clock. The longest twentieth is left out: in one of those the system may have taken the
    /// core away, for longer than all others took.
    fn working_share(&self, times: &[u64], look: u64) -> f64 {
        let mut tasks: Vec<(u64, u64)> = Vec::new();
        let mut within = false;
        for (&(_, activity), time) in self.marks.iter().zip(times.windows(2)) {
            let took = (time[1] - time[0]).saturating_sub(look);
            match (activity, tasks.last_mut()) {
                (Some(Activity::Working), _) => tasks.push((took, 0)),
                (Some(Activity::Sending), Some((_, sending))) if within => *sending += took,
                _ => {}
            }
            // A wait may be in the middle of a task, for a lock.
            let ends = matches!(activity, None | Some(Activity::Idle | Activity::Barrier));
            within = !ends && (within || activity == Some(Activity::Working));
        }
        tasks.sort_by_key(|(working, sending)| working + sending);
        tasks.truncate(tasks.len() - tasks.len() / 20);
        let (working, sending) = tasks.iter().fold((0, 0), |sum, task| (sum.0 + task.0, sum.1 + task.1));
        if working + sending == 0 { 1.0 } else { working as f64 / (working + sending) as f64 }
    }
}

/// Spans in the making: those of no length are left out, and like ones that touch are one.
#[derive(Default)]
struct Spans(Vec<Span>);

impl Spans {
    fn add(&mut self, activity: Activity, start: u64, end: u64, estimated: bool) {
        if start == end {
            return;
        }
        match self.0.last_mut() {
            Some(last) if (last.activity, last.estimated) == (activity, estimated) => last.end = end,
            _ => self.0.push(Span { activity, start, end, estimated }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Activity::{Barrier, Idle, Sending, Waiting, Working};

    fn spans(marks: &Marks, end: u64) -> Vec<(Activity, u64, u64, bool)> {
        let spans = marks.spans(&Reading { ticks: |at| at - 100, end, look: 1 });
        spans.into_iter().map(|span| (span.activity, span.start, span.end, span.estimated)).collect()
    }

    fn marked(room: usize, list: &[(u64, Option<Activity>)]) -> Marks {
        let mut marks = Marks::new(room);
        list.iter().for_each(|&(at, activity)| marks.mark(at, activity));
        marks
    }

    #[test]
    fn spans_cover_the_trace_from_end_to_end() {
        assert_eq!(spans(&marked(9, &[]), 50), [(Idle, 0, 50, false)]);
        let marks = marked(
            9,
            &[(110, Some(Sending)), (110, Some(Working)), (130, Some(Working)), (140, Some(Barrier))],
        );
        assert_eq!(
            spans(&marks, 50),
            [(Barrier, 0, 10, false), (Working, 10, 40, false), (Barrier, 40, 50, false)]
        );
    }

    #[test]
    fn tasks_not_looked_into_are_split_as_those_that_were() {
        // Thirty ticks of work to ten of sending, without the look at the clock that each span holds; what is
        // sent before the first task and what is waited for do not count.
        let list = [
            (100, Some(Sending)),
            (150, Some(Working)),
            (181, Some(Waiting)),
            (190, Some(Sending)),
            (201, None),
            (241, Some(Idle)),
        ];
        let found = spans(&marked(9, &list), 200);
        assert_eq!(found[4..6], [(Working, 101, 131, true), (Sending, 131, 141, true)]);
        let none = marked(9, &[(100, None)]);
        assert_eq!(spans(&none, 20), [(Working, 0, 20, true)], "all is work where nothing was looked into");
    }

    #[test]
    fn a_core_taken_away_in_one_task_says_nothing_of_the_others() {
        let mut marks = Marks::new(100);
        let mut now = 100;
        for task in 0..20 {
            marks.mark(now, Some(Working));
            marks.mark(now + 31, Some(Sending));
            now += if task == 7 { 10_000 } else { 42 };
        }
        marks.mark(now, None);
        let found = spans(&marks, now - 100 + 40);
        assert_eq!(found[40..].iter().map(|span| span.2 - span.1).collect::<Vec<_>>(), [30, 10]);
    }

    #[test]
    fn marks_without_room_are_counted_and_end_the_spans() {
        let mut marks = marked(2, &[(100, Some(Working)), (110, Some(Idle)), (120, Some(Working))]);
        marks.mark(130, Some(Barrier));
        assert_eq!(marks.lost(), 2);
        assert_eq!(spans(&marks, 40), [(Working, 0, 10, false), (Idle, 10, 20, false)]);
        marks.clear();
        marks.mark(110, Some(Idle));
        assert_eq!((marks.lost(), marks.now()), (0, Some(Idle)));
    }
}
