//! Caches, coherence, and the bus or the directories of a simulated multiprocessor.
//!
//! Each line is in one of the states of a MOESI protocol, kept as (owner, dirty, sharers):
//! modified/exclusive = an owner who is the only sharer; owned = a dirty owner among sharers;
//! shared = sharers without a dirty owner. A transaction waits for the bus and for the line, and
//! occupies the bus for a while. A line on its way to a new owner is held until that one has it, so
//! that contended lines are handed on one writer at a time; readers are served side by side.
//!
//! Where nodes form a network, each line has a home node whose memory and directory stand in for the bus: a request
//! travels there, takes its turn, and travels on to the owner, if that is somebody else, and back. A dirty line
//! that is read goes home clean, and the directory tells each other holder that its copy is void. An operation at
//! memory leaves no copies.
//!
//! A request takes time to reach the owner, who meanwhile goes on using the line: for `burst` cycles
//! after it was asked (or after it got the line, if that is later) its accesses still hit. They come
//! before the line leaves, so whoever asked sees them when it arrives.

use super::model::Model;
use super::network::{Home, Network, Topology};

const NOBODY: u16 = u16::MAX;

/// What an access does to a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Access {
    Read,
    Write,
}

/// How an access was served, with the time at which it is complete.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Served {
    pub(super) done: u64,
    pub(super) hit: bool,
}

#[derive(Clone, Copy)]
struct Line {
    owner: u16,
    dirty: bool,
    /// Whether somebody sleeps until this line is written.
    watched: bool,
    busy_until: u64,
    /// Who had the line before, and until when it goes on using it.
    leaver: u16,
    leaves_at: u64,
    /// Number of the last write to the line, 0 for none.
    written: u64,
}

const FRESH: Line = Line {
    owner: NOBODY,
    dirty: false,
    watched: false,
    busy_until: 0,
    leaver: NOBODY,
    leaves_at: 0,
    written: 0,
};

/// The state of all lines and caches.
pub(super) struct Coherence {
    lines: Vec<Line>,
    /// `words` bits words a line: who has a copy.
    sharers: Vec<u64>,
    words: usize,
    l1: Vec<Vec<u32>>,
    /// Empty as long as all of memory fits into the second-level cache: then nothing is ever evicted.
    l2: Vec<Vec<u32>>,
    /// When the bus, or each node's memory, has served all who have asked.
    free: Vec<u64>,
    /// The home of each page, [`NOBODY`] while it has none.
    homes: Vec<u16>,
    lines_a_page: usize,
    writes: u64,
    /// Transactions on the bus so far.
    pub(super) transactions: u64,
}

impl Coherence {
    pub(super) fn new() -> Self {
        Coherence {
            lines: Vec::new(),
            sharers: Vec::new(),
            words: 1,
            l1: Vec::new(),
            l2: Vec::new(),
            free: vec![0],
            homes: Vec::new(),
            lines_a_page: 1,
            writes: 0,
            transactions: 0,
        }
    }

    /// Makes room for `lines` lines and `processors` processors. What is cached stays cached.
    pub(super) fn grow(&mut self, model: &Model, lines: usize, processors: usize) {
        let words = processors.div_ceil(64);
        if words > self.words {
            let old = std::mem::take(&mut self.sharers);
            self.sharers = vec![0; self.lines.len() * words];
            for (new, old) in self.sharers.chunks_mut(words).zip(old.chunks(self.words)) {
                new[..old.len()].copy_from_slice(old);
            }
            self.words = words;
        }
        if lines > self.lines.len() {
            self.lines.resize(lines, FRESH);
            self.sharers.resize(lines * self.words, 0);
        }
        self.lines_a_page = (model.network.page / model.line_bytes).max(1);
        self.homes.resize(self.lines.len().div_ceil(self.lines_a_page), NOBODY);
        let nodes = model.network.nodes(processors.max(model.processors));
        self.free.resize(nodes.max(self.free.len()), 0);
        while self.l1.len() < processors {
            self.l1.push(vec![u32::MAX; model.l1_lines]);
        }
        if self.lines.len() > model.l2_lines {
            while self.l2.len() < self.l1.len() {
                self.l2.push(vec![u32::MAX; model.l2_lines]);
            }
        }
    }

    #[inline]
    fn shares(&self, line: u32, p: u16) -> bool {
        self.sharers[line as usize * self.words + usize::from(p) / 64] >> (p % 64) & 1 == 1
    }

    #[inline]
    fn row(&mut self, line: u32) -> &mut [u64] {
        let at = line as usize * self.words;
        &mut self.sharers[at..at + self.words]
    }

    fn sole_sharer(&self, line: u32, p: u16) -> bool {
        let at = line as usize * self.words;
        let row = &self.sharers[at..at + self.words];
        row.iter()
            .enumerate()
            .all(|(w, &bits)| bits == if w == usize::from(p) / 64 { 1 << (p % 64) } else { 0 })
    }

    /// Serves an access of processor `p` to `line` that is made at `now`; if it needs a transaction, that
    /// comes after `after`, when the processor's earlier stores are through.
    #[inline]
    pub(super) fn access(
        &mut self,
        model: &Model,
        (p, line): (u16, u32),
        access: Access,
        now: u64,
        after: u64,
    ) -> Served {
        if access == Access::Write {
            self.writes += 1;
            self.lines[line as usize].written = self.writes;
        }
        let have = self.shares(line, p);
        let state = self.lines[line as usize];
        if have && (access == Access::Read || (state.owner == p && self.sole_sharer(line, p))) {
            self.lines[line as usize].dirty |= access == Access::Write;
            let time = if self.fill_l1(model, p, line) { model.l1_hit } else { model.l2_hit };
            return Served { done: now + time, hit: true };
        }
        if state.leaver == p && now < state.leaves_at {
            return Served { done: now + model.l1_hit, hit: true };
        }
        let owned_elsewhere = state.dirty && state.owner != p && state.owner != NOBODY;
        let (here, home) = (model.network.node_of(p), self.home(model, line, p));
        let way = model.network.travel(here, home);
        let (told, farthest) = match access {
            Access::Write => self.others(&model.network, line, p, home),
            Access::Read => (0, 0),
        };
        // The request takes its turn on the bus or at home when it gets there; a line in transit is waited for after.
        let start = (now + way / 2).max(self.free[home]);
        self.free[home] = start + model.bus_occupancy + told * model.network.message;
        let start = start - way / 2;
        self.transactions += 1;
        let latency = match (have, owned_elsewhere) {
            (true, _) => model.upgrade + way + farthest,
            (false, true) => {
                let owner = model.network.node_of(state.owner);
                let round = way + model.network.travel(home, owner) + model.network.travel(owner, here);
                model.cache_to_cache + round / 2
            }
            (false, false) => model.memory + way + farthest,
        };
        let asked = start.max(after).max(state.busy_until);
        let done = asked + latency;
        let alone = self.row(line).iter().all(|&bits| bits == 0);
        let entry = &mut self.lines[line as usize];
        if owned_elsewhere && model.burst > 0 {
            (entry.leaver, entry.leaves_at) = (state.owner, asked + model.burst);
        }
        match access {
            Access::Write => {
                // Whoever comes next waits until the new owner has the line. A copy to a reader holds
                // nobody up: its source still has the data, and the bus is free again.
                entry.busy_until = done;
                entry.owner = p;
                entry.dirty = true;
                self.row(line).fill(0);
            }
            Access::Read if alone => {
                entry.owner = p;
                entry.dirty = false;
            }
            // A dirty owner on a bus stays the one who serves the line; a clean exclusive one becomes a sharer.
            Access::Read if !entry.dirty || model.network.topology != Topology::Bus => {
                entry.owner = NOBODY;
                entry.dirty = false;
            }
            Access::Read => {}
        }
        self.row(line)[usize::from(p) / 64] |= 1 << (p % 64);
        if !have {
            self.fill_l2(model, p, line);
        }
        self.fill_l1(model, p, line);
        Served { done, hit: false }
    }

    /// Serves an atomic operation that the line's home carries out. Copies of the line are void then.
    pub(super) fn at_memory(&mut self, model: &Model, (p, line): (u16, u32), now: u64) -> Served {
        self.writes += 1;
        let home = self.home(model, line, p);
        let way = model.network.travel(model.network.node_of(p), home);
        let (told, farthest) = self.others(&model.network, line, NOBODY, home);
        let start = (now + way / 2).max(self.free[home]).max(self.lines[line as usize].busy_until);
        self.free[home] = start + model.network.at_memory + told * model.network.message;
        self.transactions += 1;
        self.row(line).fill(0);
        let entry = &mut self.lines[line as usize];
        let fetched = if std::mem::take(&mut entry.dirty) { model.cache_to_cache } else { 0 };
        (entry.owner, entry.written) = (NOBODY, self.writes);
        Served { done: start + fetched + farthest + model.memory + way - way / 2, hit: false }
    }

    /// The node in whose memory the line lies, `p` being the one who asks for it.
    #[inline]
    fn home(&mut self, model: &Model, line: u32, p: u16) -> usize {
        let network = &model.network;
        if network.topology == Topology::Bus {
            return 0;
        }
        let page = line as usize / self.lines_a_page;
        let home = &mut self.homes[page];
        if *home == NOBODY {
            *home = match network.home {
                Home::FirstTouch => network.node_of(p),
                Home::Interleaved => page % network.nodes(model.processors),
            } as u16;
        }
        usize::from(*home)
    }

    /// How many others than `p` have copies of the line, and the longest way from its home to one of them.
    fn others(&self, network: &Network, line: u32, p: u16, home: usize) -> (u64, u64) {
        if network.topology == Topology::Bus {
            return (0, 0);
        }
        let at = line as usize * self.words;
        let (mut told, mut farthest) = (0, 0);
        for (word, &row) in self.sharers[at..at + self.words].iter().enumerate() {
            let mut bits = row;
            while bits != 0 {
                let other = (word * 64) as u16 + bits.trailing_zeros() as u16;
                bits &= bits - 1;
                if other != p {
                    told += 1;
                    farthest = farthest.max(network.travel(home, network.node_of(other)));
                }
            }
        }
        (told, farthest)
    }

    /// Puts the line into the first-level cache; says whether it was there.
    #[inline]
    fn fill_l1(&mut self, model: &Model, p: u16, line: u32) -> bool {
        let tag = &mut self.l1[usize::from(p)][line as usize & (model.l1_lines - 1)];
        std::mem::replace(tag, line) == line
    }

    /// Puts the line into the second-level cache, throwing out what sat there.
    fn fill_l2(&mut self, model: &Model, p: u16, line: u32) {
        let Some(tags) = self.l2.get_mut(usize::from(p)) else { return };
        let out = std::mem::replace(&mut tags[line as usize & (model.l2_lines - 1)], line);
        if out == u32::MAX || out == line {
            return;
        }
        let home = self.home(model, out, p);
        self.row(out)[usize::from(p) / 64] &= !(1 << (p % 64));
        let entry = &mut self.lines[out as usize];
        if entry.owner == p {
            entry.owner = NOBODY;
            if std::mem::take(&mut entry.dirty) {
                // A write-back takes its turn on the bus or at home; nobody waits for it.
                self.free[home] += model.bus_occupancy;
            }
        }
    }

    /// The number of the newest write so far.
    pub(super) fn newest_write(&self) -> u64 {
        self.writes
    }

    /// Whether `line` was written after write number `since`.
    pub(super) fn written_since(&self, line: u32, since: u64) -> bool {
        self.lines[line as usize].written > since
    }

    pub(super) fn watch(&mut self, line: u32) {
        self.lines[line as usize].watched = true;
    }

    /// Whether somebody watched the line; they no longer do.
    #[inline]
    pub(super) fn take_watch(&mut self, line: u32) -> bool {
        std::mem::take(&mut self.lines[line as usize].watched)
    }
}

#[cfg(test)]
mod tests;
