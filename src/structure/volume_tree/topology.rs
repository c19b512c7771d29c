//! The shape of a tree over triangles, from their middles alone.
//!
//! A range is cut at the mean of its middles along the axis on which they spread most; a box gets its up to eight
//! children by cutting, again and again, the range whose box has the largest surface.

use super::{BLOCK, LEAF, Link};
use crate::geometry::Aabb;
use glam::Vec3;

/// A triangle to be placed.
#[derive(Clone, Copy)]
pub(super) struct Item {
    pub(super) middle: Vec3,
    pub(super) index: u32,
}

/// The boxes of a tree, the items of each, and the order of the items.
pub(super) struct Topology {
    pub(super) links: Vec<Link>,
    pub(super) items: Vec<(u32, u32)>,
}

/// A part of the items, and what is around their middles.
#[derive(Clone, Copy)]
struct Part {
    first: usize,
    end: usize,
    bounds: Aabb,
    sum: Vec3,
}

impl Part {
    fn len(&self) -> usize {
        self.end - self.first
    }

    fn surface(&self) -> f32 {
        let size = self.bounds.max - self.bounds.min;
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    fn of(items: &[Item], first: usize) -> Self {
        let (mut bounds, mut sum) = (Aabb::EMPTY, Vec3::ZERO);
        for item in items {
            bounds = bounds.with_point(item.middle);
            sum += item.middle;
        }
        Self { first, end: first + items.len(), bounds, sum }
    }

    /// Cuts it in two, neither of them empty; it has at least two items.
    fn cut(&self, items: &mut [Item]) -> [Self; 2] {
        let items = &mut items[self.first..self.end];
        let size = self.bounds.max - self.bounds.min;
        let axis = if size.x >= size.y.max(size.z) {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let mean = self.sum[axis] / items.len() as f32;
        let mut low = 0;
        for i in 0..items.len() {
            if items[i].middle[axis] < mean {
                items.swap(low, i);
                low += 1;
            }
        }
        if low == 0 || low == items.len() {
            // All in one place, as far as f32 can tell.
            low = items.len() / 2;
        }
        let (before, after) = items.split_at(low);
        [Self::of(before, self.first), Self::of(after, self.first + low)]
    }
}

/// Puts items in order, and boxes over them with at most `leaf` items in each leaf.
pub(super) fn build(items: &mut [Item], leaf: usize) -> Topology {
    let mut topology = Topology { links: Vec::new(), items: Vec::new() };
    if items.is_empty() {
        return topology;
    }
    // Of triangles that lie evenly there are about as many boxes, unused ones included.
    let boxes = 3 * items.len() / leaf;
    topology.links.reserve(boxes);
    topology.items.reserve(boxes);
    topology.grow(1);
    let mut stack = vec![(0, Part::of(items, 0))];
    let mut parts = Vec::with_capacity(BLOCK);
    while let Some((at, part)) = stack.pop() {
        topology.items[at] = (part.first as u32, part.end as u32);
        if part.len() <= leaf {
            topology.links[at] =
                Link { first: part.first as u32, count: part.len() as u32 | LEAF, surface: 0.0 };
            continue;
        }
        parts.clear();
        parts.push(part);
        while parts.len() < BLOCK {
            let large = (0..parts.len()).filter(|&i| parts[i].len() > leaf);
            let Some(i) = large.max_by(|&i, &j| parts[i].surface().total_cmp(&parts[j].surface())) else {
                break;
            };
            let [before, after] = parts[i].cut(items);
            parts[i] = before;
            // In the order of their items, so that a box's are in one piece.
            parts.insert(i + 1, after);
        }
        let first = topology.grow(parts.len());
        topology.links[at] = Link { first: first as u32, count: parts.len() as u32, surface: 0.0 };
        stack.extend(parts.iter().enumerate().map(|(i, part)| (first + i, *part)));
    }
    topology
}

impl Topology {
    /// Makes room for boxes in blocks of their own; returns the first.
    pub(super) fn grow(&mut self, boxes: usize) -> usize {
        let first = self.links.len();
        let len = first + boxes.next_multiple_of(BLOCK);
        self.links.resize(len, Link::UNUSED);
        self.items.resize(len, (0, 0));
        first
    }
}
