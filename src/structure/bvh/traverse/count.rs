//! What rays take, counted or not.

/// Is told what a ray does. [`Uncounted`] makes nothing of it, at no cost.
pub(in crate::structure::bvh) trait Count {
    fn node(&mut self);
    fn block(&mut self);
}

/// Nothing is counted.
pub(in crate::structure::bvh) struct Uncounted;

impl Count for Uncounted {
    #[inline(always)]
    fn node(&mut self) {}
    #[inline(always)]
    fn block(&mut self) {}
}

/// What rays took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// Nodes, of eight boxes each, that were tested.
    pub nodes: u64,
    /// Blocks, of up to four triangles each, that were tested.
    pub blocks: u64,
}

impl Count for RayCounts {
    fn node(&mut self) {
        self.nodes += 1;
    }
    fn block(&mut self) {
        self.blocks += 1;
    }
}

impl std::ops::AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.nodes += other.nodes;
        self.blocks += other.blocks;
    }
}
