//! The top of a hierarchy whose lower pieces are grown apart, and how it is put together again.

use super::effort::Effort;
use super::grow::budding;
use super::lanes::Box8;
use super::phased::{Piece, Team, cut_off, lock};
use crate::structure::bvh::{BinaryBvh, BinaryNode};
use std::sync::Mutex;

/// A node of the top: two below it, or a piece.
#[derive(Clone, Copy, Debug)]
enum Below {
    Nodes([usize; 2]),
    Piece(usize),
}

/// The top: node 0 is the root.
pub(super) struct Top {
    nodes: Vec<(Box8, Below)>,
    pub(super) pieces: Vec<Piece>,
}

impl Top {
    /// A root of which nothing is known.
    pub(super) fn new() -> Self {
        Self { nodes: vec![(Box8::EMPTY, Below::Nodes([0; 2]))], pieces: Vec::new() }
    }

    /// Puts two nodes below one that has so far nothing; returns their numbers.
    pub(super) fn part(&mut self, node: usize, bounds: Box8) -> [usize; 2] {
        let pair = [self.nodes.len(), self.nodes.len() + 1];
        self.nodes[node] = (bounds, Below::Nodes(pair));
        self.nodes.extend([(Box8::EMPTY, Below::Nodes([0; 2])); 2]);
        pair
    }

    /// Makes a node a piece.
    pub(super) fn end(&mut self, node: usize, piece: Piece) {
        self.nodes[node] = (piece.extent.bounds, Below::Piece(self.pieces.len()));
        self.pieces.push(piece);
    }

    /// Puts the hierarchy together from what was grown for each piece, numbered as if it had been grown in one.
    pub(super) fn assemble<T: Team>(
        &self,
        grown: &[Vec<BinaryNode>],
        bvh: &mut BinaryBvh,
        team: &mut T,
    ) -> Result<(), T::Error> {
        let pieces: usize = grown[..self.pieces.len()].iter().map(Vec::len).sum();
        let inner = self.nodes.len() - self.pieces.len();
        let total = pieces + inner;
        bvh.nodes.truncate(total);
        bvh.nodes.resize(total, budding(&Box8::EMPTY));
        // Where the nodes below the root of each piece go, in rising order, and what lies between them.
        let mut gaps = Vec::with_capacity(self.pieces.len());
        let mut next = 1;
        let mut open = vec![(0, 0)];
        while let Some((node, to)) = open.pop() {
            match &self.nodes[node] {
                (bounds, Below::Nodes([left, right])) => {
                    bvh.nodes[to] = BinaryNode { first: next as u32, ..budding(bounds) };
                    open.extend([(*right, next + 1), (*left, next)]);
                    next += 2;
                }
                (_, Below::Piece(piece)) => {
                    bvh.nodes[to] = moved(&grown[*piece][0], next);
                    gaps.push((*piece, next));
                    next += grown[*piece].len() - 1;
                }
            }
        }
        let (mut rest, mut at) = (&mut bvh.nodes[..], 0);
        let mut copies = Vec::with_capacity(gaps.len());
        for (piece, base) in gaps {
            cut_off(&mut rest, base - at);
            let length = grown[piece].len() - 1;
            copies.push(Mutex::new((piece, base, cut_off(&mut rest, length))));
            at = base + length;
        }
        team.alone(Effort { nodes: self.nodes.len() as u64, ..Effort::default() })?;
        team.each(copies.len(), |i| {
            let (piece, base, to) = &mut *lock(&copies[i]);
            for (to, node) in to.iter_mut().zip(&grown[*piece][1..]) {
                *to = moved(node, *base);
            }
            Effort { nodes: to.len() as u64, ..Effort::default() }
        })
    }
}

/// A node of a piece whose nodes, but for its root, begin at `base`.
fn moved(node: &BinaryNode, base: usize) -> BinaryNode {
    let by = if node.is_leaf() { 0 } else { base as u32 - 1 };
    BinaryNode { first: node.first + by, ..*node }
}
