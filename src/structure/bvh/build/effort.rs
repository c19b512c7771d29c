//! What building did, in counts that its time can be reckoned from on machines where it takes none.

use std::ops::AddAssign;

/// What building did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Boxes copied in.
    pub loaded: u64,
    /// Items put into the bins of a node, along all axes.
    pub binned: u64,
    /// Bins emptied, joined with others or weighed, each once for each.
    pub bins: u64,
    /// Nodes of so few items that no bins were filled.
    pub few: u64,
    /// Items moved to a side of a cut, or gone through where they are halved as they lie.
    pub moved: u64,
    /// Nodes made, or copied to where they belong.
    pub nodes: u64,
    /// Items put into the cells of a grid.
    pub gridded: u64,
    /// Items whose cell was looked up, to be counted or moved.
    pub located: u64,
    /// Cells emptied, joined with others or weighed, each once for each.
    pub cells: u64,
}

impl AddAssign for Effort {
    fn add_assign(&mut self, other: Self) {
        self.loaded += other.loaded;
        self.binned += other.binned;
        self.bins += other.bins;
        self.few += other.few;
        self.moved += other.moved;
        self.nodes += other.nodes;
        self.gridded += other.gridded;
        self.located += other.located;
        self.cells += other.cells;
    }
}
