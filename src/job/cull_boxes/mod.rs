//! Culling of a flat array of boxes, shared out in pieces: all boxes by a kernel, or the blocks that a shallow
//! hierarchy leaves over; and, to hold it against, the bare reading of the same memory.
//!
//! A [`BoxField`] is the boxes as they lie in a machine's shared memory, with the mask; a [`Frame`] is the job of one
//! camera, which any tile scheme can share out. A piece of the flat array is as many blocks as fill 64 bytes of the
//! mask, of the hierarchy a group, so that no two processors write one line of it on most machines.

mod costs;
mod random;

use crate::geometry::{Aabb, BoxBlock, BoxTest, Frustum, culling};
use crate::machine::{Layout, Machine, Processor, Shared, Word};
use crate::scheme::tiles::TileWork;
use crate::structure::{BitMask, BoxTree, BoxTreeView, Boxes, Looked};
pub use costs::Costs;
pub use random::{camera, random_boxes};
use std::ops::Range;
use std::sync::atomic::Ordering;

/// Blocks in a piece of the flat array: their mask words fill 64 bytes.
const FLAT_PIECE: usize = 8;

/// How the boxes are gone through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Every block, by the kernel.
    Flat,
    /// By groups: a block only where the boxes around it leave it open.
    Hierarchy,
    /// One box after the other from an array of structures, by [`culling::basic`]: what one writes first.
    Plain,
    /// Reading every block and doing nothing with it: what memory alone takes.
    Stream,
}

/// Boxes in a machine's shared memory, and the mask of those seen last.
pub struct BoxField<M: Machine> {
    len: usize,
    filled: usize,
    blocks: Shared<BoxBlock>,
    bounds: Shared<BoxBlock>,
    groups: Shared<Aabb>,
    /// For [`Way::Plain`].
    structures: Shared<Aabb>,
    /// Words, so that two processors at one piece, which no scheme allows, would waste their time and no more.
    mask: Shared<M::Word>,
}

impl<M: Machine> BoxField<M> {
    /// Puts the boxes of a tree, in its order, into the machine's memory. With `structures` they are there twice, also
    /// as [`Way::Plain`] reads them.
    pub fn new(machine: &M, tree: &BoxTree, structures: bool) -> Self {
        let view = tree.view();
        let copy = |blocks: &[BoxBlock]| machine.alloc(blocks.len(), Layout::Packed, |i| blocks[i]);
        let boxes = if structures { tree.boxes().len() } else { 0 };
        BoxField {
            len: tree.boxes().len(),
            filled: view.filled,
            blocks: copy(view.blocks),
            bounds: copy(view.bounds),
            groups: machine.alloc(view.groups.len(), Layout::Packed, |i| view.groups[i]),
            structures: machine.alloc(boxes, Layout::Packed, |i| tree.boxes().get(i)),
            mask: machine.alloc(view.blocks.len(), Layout::Packed, |_| Word::new(0)),
        }
    }

    /// How many boxes there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Bytes of the boxes as a kernel reads them.
    pub fn bytes(&self) -> usize {
        self.blocks.len() * size_of::<BoxBlock>()
    }

    /// The mask that the last run left. `&mut`, for no run may be going on.
    pub fn mask(&mut self) -> BitMask {
        let mut mask = BitMask::new(self.len);
        for (word, found) in mask.words_mut().iter_mut().zip(self.mask.iter()) {
            // ORDERING: Relaxed: a run borrows the field, so none is going on, and its end has been waited for.
            *word = found.load(Ordering::Relaxed);
        }
        mask
    }

    fn view(&self) -> BoxTreeView<'_> {
        BoxTreeView {
            blocks: self.blocks.as_slice(),
            bounds: self.bounds.as_slice(),
            groups: self.groups.as_slice(),
            filled: self.filled,
        }
    }
}

/// The mask one by one from an array of structures: what [`Way::Plain`] is to find.
pub fn plain(boxes: &Boxes, frustum: &Frustum) -> BitMask {
    let mut mask = BitMask::new(boxes.len());
    let seen = |i: usize| u64::from(is_seen(&boxes.get(i), frustum)) << (i % BoxBlock::LEN);
    (0..boxes.len()).for_each(|i| mask.words_mut()[i / BoxBlock::LEN] |= seen(i));
    mask
}

#[inline]
fn is_seen(bounds: &Aabb, frustum: &Frustum) -> bool {
    !matches!(culling::basic(bounds, frustum).side, culling::Side::Outside(_))
}

/// The culling of one field for one camera, as independent pieces.
pub struct Frame<'a, M: Machine> {
    field: &'a BoxField<M>,
    way: Way,
    frustum: &'a Frustum,
    test: BoxTest,
    costs: Costs,
}

impl<'a, M: Machine> Frame<'a, M> {
    /// The job of one camera; `test` is that of `frustum`.
    pub fn new(field: &'a BoxField<M>, way: Way, frustum: &'a Frustum, test: BoxTest, costs: Costs) -> Self {
        Frame { field, way, frustum, test, costs }
    }

    /// Blocks in a piece.
    fn piece(&self) -> usize {
        if self.way == Way::Hierarchy { BoxBlock::LEN } else { FLAT_PIECE }
    }

    /// Culls the blocks of a piece into the words.
    #[inline]
    fn cull<P: Processor>(&self, blocks: Range<usize>, words: &mut [u64], cpu: &P) {
        let field = self.field;
        match self.way {
            Way::Flat => {
                self.test.visible(&field.blocks.as_slice()[blocks.clone()], words);
                for block in blocks {
                    touch(&field.blocks[block], cpu);
                    cpu.charge(self.costs.block());
                }
            }
            Way::Hierarchy => {
                let group = blocks.start / BoxBlock::LEN;
                field.view().cull_groups(self.frustum, &self.test, group..group + 1, words, |looked| {
                    match looked {
                        Looked::Group(group) => cpu.touch(&field.groups[group]),
                        Looked::Bounds(group) => touch(&field.bounds[group], cpu),
                        Looked::Block(block) => touch(&field.blocks[block], cpu),
                    }
                    cpu.charge(self.costs.of(looked));
                });
            }
            Way::Plain => {
                for (block, word) in blocks.zip(words) {
                    let boxes = BoxBlock::LEN * block..field.len.min(BoxBlock::LEN * (block + 1));
                    *word = 0;
                    for (bit, bounds) in field.structures.as_slice()[boxes].iter().enumerate() {
                        cpu.touch(bounds);
                        *word |= u64::from(is_seen(bounds, self.frustum)) << bit;
                    }
                    cpu.charge(self.costs.block());
                }
            }
            Way::Stream => {
                let mut bits = [0_u32; 16];
                for block in blocks {
                    touch(&field.blocks[block], cpu);
                    let columns = field.blocks[block].columns();
                    let parts = columns.flat_map(|column| column.as_chunks::<16>().0);
                    parts.for_each(|part| bits.iter_mut().zip(part).for_each(|(a, b)| *a ^= b.to_bits()));
                }
                // Nobody asks for the bits, which the compiler is not to know.
                std::hint::black_box(bits);
            }
        }
    }
}

/// Reads a block for a simulated machine: in parts no longer than a line, so that others get their turn on the bus
/// between them.
#[inline]
fn touch<P: Processor>(block: &BoxBlock, cpu: &P) {
    // Two plain loops of known length, which vanish where a touch does nothing.
    for column in block.columns() {
        for part in column.as_chunks::<8>().0 {
            cpu.touch(part);
        }
    }
}

impl<M: Machine> TileWork for Frame<'_, M> {
    type Found = ();

    fn pieces(&self) -> usize {
        self.field.blocks.len().div_ceil(self.piece())
    }

    fn found(&self) {}

    #[inline]
    fn work_on<P: Processor>(&self, pieces: Range<usize>, _found: &mut (), cpu: &P) {
        let size = self.piece();
        for piece in pieces {
            let blocks = size * piece..self.field.blocks.len().min(size * (piece + 1));
            let mut words = [0; BoxBlock::LEN];
            let words = &mut words[..blocks.len()];
            self.cull(blocks.clone(), words, cpu);
            if self.way == Way::Stream {
                continue;
            }
            for (block, word) in blocks.zip(words) {
                // ORDERING: Relaxed: nobody reads the mask before the run has ended, which whoever asked for it waits for.
                self.field.mask[block].store(*word, Ordering::Relaxed);
            }
        }
    }
}

#[cfg(test)]
mod tests;
