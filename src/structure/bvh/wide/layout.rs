//! Nodes and blocks of triangles as they lie in memory.

use crate::geometry::Aabb;
use crate::geometry::hit::Corners;
use crate::geometry::lanes::Lanes;
use glam::Vec3;

/// Children a node.
pub(in crate::structure::bvh) const WIDTH: usize = 8;
/// Triangles a block.
pub(in crate::structure::bvh) const TRIANGLES: usize = 4;

/// What a node has below: a node, or blocks that follow one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::structure::bvh) struct Child(u32);

impl Child {
    const BITS: u32 = 28;
    const MOST: usize = (1 << Self::BITS) - 1;
    /// Most blocks of one leaf.
    pub(in crate::structure::bvh) const BLOCKS: usize = 15;
    /// Nothing; no ray comes here, as its box is empty.
    pub(in crate::structure::bvh) const NONE: Self = Self(0);

    pub(super) fn node(index: usize) -> Self {
        assert!(index <= Self::MOST, "nodes can be numbered");
        Self(index as u32)
    }

    pub(super) fn leaf(first: usize, blocks: usize) -> Self {
        assert!(first <= Self::MOST && (1..=Self::BLOCKS).contains(&blocks), "blocks can be numbered");
        Self(first as u32 | (blocks as u32) << Self::BITS)
    }

    #[inline(always)]
    pub(in crate::structure::bvh) fn bits(self) -> u32 {
        self.0
    }

    #[inline(always)]
    pub(in crate::structure::bvh) fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// How many blocks; 0 of a node.
    #[inline(always)]
    pub(in crate::structure::bvh) fn blocks(self) -> usize {
        (self.0 >> Self::BITS) as usize
    }

    /// Which node, or which block is first.
    #[inline(always)]
    pub(in crate::structure::bvh) fn index(self) -> usize {
        self.0 as usize & Self::MOST
    }
}

/// Eight boxes and what is in them.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(in crate::structure::bvh) struct Node {
    /// By axis, then least and greatest, then child.
    pub(in crate::structure::bvh) planes: [[f32; WIDTH]; 6],
    pub(in crate::structure::bvh) children: [Child; WIDTH],
}

impl Node {
    pub(super) const EMPTY: Self = {
        let (least, greatest) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Self { planes: [least, greatest, least, greatest, least, greatest], children: [Child::NONE; WIDTH] }
    };

    /// One row of planes, of the children from `from` on.
    ///
    /// # Safety
    /// `row` is below 6, there are as many children from `from` on as there are lanes, whose unit the processor has.
    #[inline(always)]
    pub(in crate::structure::bvh) unsafe fn row<L: Lanes>(&self, row: usize, from: usize) -> L {
        // SAFETY: as above.
        unsafe { L::load(self.planes.get_unchecked(row), from) }
    }

    /// The box of a child.
    pub(super) fn bounds(&self, i: usize) -> Aabb {
        let corner = |from: usize| Vec3::from_array([0, 2, 4].map(|row| self.planes[row + from][i]));
        Aabb { min: corner(0), max: corner(1) }
    }

    /// The boxes of its children.
    pub(super) fn boxes(&self) -> impl Iterator<Item = Aabb> {
        (0..WIDTH).map(|i| self.bounds(i)).filter(|bounds| !bounds.is_empty())
    }

    pub(super) fn set(&mut self, i: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.planes[2 * axis][i] = bounds.min[axis];
            self.planes[2 * axis + 1][i] = bounds.max[axis];
        }
        self.children[i] = child;
    }
}

/// Four triangles.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub(in crate::structure::bvh) struct Block {
    /// By corner, then axis, then triangle. Of those that are not there: NaN.
    pub(in crate::structure::bvh) corners: [[f32; TRIANGLES]; 9],
    pub(in crate::structure::bvh) items: [u32; TRIANGLES],
}

impl Block {
    pub(super) const EMPTY: Self = Self { corners: [[f32::NAN; TRIANGLES]; 9], items: [u32::MAX; TRIANGLES] };

    pub(super) fn set(&mut self, i: usize, corners: [Vec3; 3], item: u32) {
        for (column, value) in
            self.corners.iter_mut().zip(corners.iter().flat_map(|corner| corner.to_array()))
        {
            column[i] = value;
        }
        self.items[i] = item;
    }
}

/// Triangles of a block, from `from` on, one a lane.
pub(in crate::structure::bvh) struct Together<'a> {
    pub(in crate::structure::bvh) block: &'a Block,
    pub(in crate::structure::bvh) from: usize,
}

impl<L: Lanes> Corners<L> for Together<'_> {
    #[inline(always)]
    unsafe fn at(&self, corner: usize, axis: usize) -> L {
        // SAFETY: both are below 3; the lanes are the caller's.
        unsafe { L::load(self.block.corners.get_unchecked(3 * corner + axis), self.from) }
    }
}

/// One triangle of a block, in all lanes.
pub(in crate::structure::bvh) struct Alone<'a> {
    pub(in crate::structure::bvh) block: &'a Block,
    pub(in crate::structure::bvh) lane: usize,
}

impl<L: Lanes> Corners<L> for Alone<'_> {
    #[inline(always)]
    unsafe fn at(&self, corner: usize, axis: usize) -> L {
        // SAFETY: both are below 3; the lanes are the caller's.
        unsafe { L::splat(self.block.corners.get_unchecked(3 * corner + axis)[self.lane & (TRIANGLES - 1)]) }
    }
}
