//! Trees of volumes that are tested against one another (Paper II sec. 5): over the triangles of a mesh or over the
//! nodes of a scene graph.
//!
//! Boxes lie in blocks of eight, and the children of a box fill whole blocks, so that one volume is tested against
//! eight in one go. A tree over triangles is made for that: up to eight children a box, leaves of a few triangles. One
//! over a scene graph keeps the graph's shape.
//!
//! A body may be moved and turned without its tree being touched: the motion comes with the query. If it bends, the
//! tree can be fitted anew, which keeps its shape.

mod nodes;
mod topology;
mod triangles;

pub use triangles::in_world;

use crate::geometry::overlap::{Eight, Way};
use crate::geometry::{Aabb, Overlap, Rigid, Volume};
use crate::structure::TreeError;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Boxes in a block.
pub const BLOCK: usize = 8;

/// How many levels of boxes are fitted to every point of a body, if each holds all of them.
const LEVELS: usize = 64;

/// Where a box leads to, and how large it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// The first item of a leaf; the first box below another, a multiple of eight.
    pub first: u32,
    /// How many items, or boxes below. The highest bit says which.
    count: u32,
    /// What stands for the volume's surface, in square metres.
    pub surface: f32,
}

const LEAF: u32 = 1 << 31;

impl Link {
    /// What fills up a block.
    const UNUSED: Self = Self { first: 0, count: 0, surface: 0.0 };

    /// Whether items lie below, not boxes.
    #[inline]
    pub fn is_leaf(&self) -> bool {
        self.count & LEAF != 0
    }

    /// How many items a leaf has, or boxes there are below.
    #[inline]
    pub fn count(&self) -> u32 {
        self.count & !LEAF
    }

    /// Whether it is a box at all.
    pub fn is_used(&self) -> bool {
        self.count != 0
    }

    /// The blocks of the boxes below, each with the lanes that are in use.
    #[inline]
    pub fn blocks(&self) -> impl Iterator<Item = (u32, u8)> + use<> {
        let (first, count) = (self.first / BLOCK as u32, self.count());
        (0..count.div_ceil(BLOCK as u32)).map(move |i| {
            let left = (count - i * BLOCK as u32).min(BLOCK as u32);
            (first + i, (0xff_u32 >> (BLOCK as u32 - left)) as u8)
        })
    }
}

/// What the leaves hold.
#[derive(Clone, Debug)]
enum Items {
    /// Triangles: corner indices and corners, in the order of the tree.
    Triangles { corners: Vec<[u32; 3]>, places: Vec<[Vec3; 3]> },
    /// Nodes of a scene that have a mesh, all of their points one after the other; where each node's begin, and the last
    /// ends.
    Nodes { points: Vec<Vec3>, starts: Vec<usize> },
}

/// A tree of volumes around triangles or around scene nodes: the items.
#[derive(Clone, Debug)]
pub struct VolumeTree<V: Overlap> {
    volumes: Vec<V>,
    links: Vec<Link>,
    blocks: Vec<V::Eight>,
    /// The items of each box: first and after the last, by place in the tree.
    items: Vec<(u32, u32)>,
    /// Which item of those given stands at each place.
    order: Vec<u32>,
    content: Items,
    /// What the volumes' coordinates are relative to, so that they are as fine as the body is small, wherever it is.
    origin: DVec3,
}

/// Why a tree cannot be built or fitted.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VolumeTreeError {
    /// A corner is not a number, or too large to be measured.
    #[error("triangle {0}: a corner is not a number below 1e18 m in size")]
    Odd(usize),
    /// A corner that is not there.
    #[error("triangle {triangle}: corner {corner} of {corners}")]
    NoCorner {
        /// The triangle, from 0.
        triangle: usize,
        /// The corner's number.
        corner: u32,
        /// How many there are.
        corners: usize,
    },
    /// More than can be numbered.
    #[error("{0} items, expected at most {most}", most = u32::MAX >> 5)]
    TooMany(usize),
    /// More corners than can be numbered.
    #[error("{0} corners, expected at most {most}", most = u32::MAX)]
    TooManyCorners(usize),
    /// Leaves of none, or of more than there can be.
    #[error("leaves of {0} triangles, expected 1 to 64")]
    Leaf(usize),
    /// Fitted to the points of another body.
    #[error("{got} points, where the tree was built over {expected}")]
    Points {
        /// How many were given.
        got: usize,
        /// How many corners its triangles ask for.
        expected: usize,
    },
    /// A tree over scene nodes has no triangles to be fitted to.
    #[error("a tree over scene nodes cannot be fitted to triangles")]
    Nodes,
}

/// How a tree is shaped and how tight its volumes are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeTreeStatistics {
    /// Boxes, leaves included.
    pub boxes: usize,
    /// Leaves.
    pub leaves: usize,
    /// Boxes from the root to the deepest leaf, both included.
    pub depth: usize,
    /// Sum of the volumes' surfaces over that of the aligned boxes around the same items: below 1 is tighter.
    pub tightness: f64,
    /// Bytes it takes.
    pub bytes: usize,
}

impl<V: Overlap> VolumeTree<V> {
    /// The volumes, by box; a box that is not in use has the root's.
    pub fn volumes(&self) -> &[V] {
        &self.volumes
    }

    /// Where each box leads to: box 0 is the root.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// The volumes eight by eight.
    pub fn blocks(&self) -> &[V::Eight] {
        &self.blocks
    }

    /// Which item of those given stands at each place of the leaves.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// The triangles' corners in the order of the tree, in metres; none in a tree over scene nodes.
    pub fn triangles(&self) -> &[[Vec3; 3]] {
        match &self.content {
            Items::Triangles { places, .. } => places,
            Items::Nodes { .. } => &[],
        }
    }

    /// The triangles' corners by number, in the order of the tree; none in a tree over scene nodes.
    pub fn corners(&self) -> &[[u32; 3]] {
        match &self.content {
            Items::Triangles { corners, .. } => corners,
            Items::Nodes { .. } => &[],
        }
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.links.is_empty()
    }

    /// The way from this tree's volumes to another's, when this body is moved so, for tests whether they come
    /// nearer than `reach`, in metres.
    pub fn way_to<W: Overlap>(&self, other: &VolumeTree<W>, motion: &Rigid, reach: f64) -> Way {
        let here = Rigid::shift(self.origin).then(motion);
        // What cancels out was rounded when it was large: here, in the way back, and where triangles are moved.
        let large = self.origin.abs() + motion.translation().abs() + other.origin.abs();
        let lost = large.element_sum() * (16.0 * f64::EPSILON);
        Way::new(&here.then(&Rigid::shift(-other.origin)), reach).off_by(lost)
    }

    /// All points, relative to the origin, in the order of the items.
    fn local_points(&self) -> Vec<Vec3> {
        let local = |point: &Vec3| (point.as_dvec3() - self.origin).as_vec3();
        match &self.content {
            Items::Triangles { places, .. } => places.as_flattened().iter().map(local).collect(),
            Items::Nodes { points, .. } => points.iter().map(local).collect(),
        }
    }

    /// Which of the points are those of some items.
    fn points_of(&self, (first, end): (u32, u32)) -> Range<usize> {
        let at = |item: u32| match &self.content {
            Items::Triangles { .. } => 3 * item as usize,
            Items::Nodes { starts, .. } => starts[item as usize],
        };
        at(first)..at(end)
    }

    /// The aligned box around the items of every box, from the leaves up: boxes below come after.
    fn bounds(&self, points: &[Vec3]) -> Vec<Aabb> {
        let mut bounds = vec![Aabb::EMPTY; self.links.len()];
        for i in (0..self.links.len()).rev().filter(|&i| self.links[i].is_used()) {
            let link = self.links[i];
            bounds[i] = if link.is_leaf() {
                Aabb::around(&points[self.points_of(self.items[i])])
            } else {
                let below = &bounds[link.first as usize..(link.first + link.count()) as usize];
                let odd = below.iter().find(|bounds| bounds.is_nan());
                odd.copied().unwrap_or_else(|| below.iter().copied().fold(Aabb::EMPTY, Aabb::union))
            };
        }
        bounds
    }

    /// How many points a box may have to be fitted to each of them.
    ///
    /// All boxes of a tree that is not deep. In a chain of nodes every point lies in every box above it, and to fit
    /// them all would take time with the square of the depth; the largest must do with the box around them.
    fn most_points(&self, points: usize) -> usize {
        let used = self.items.iter().zip(&self.links).filter(|(_, link)| link.is_used());
        let mut counts: Vec<usize> = used.map(|(&items, _)| self.points_of(items).len()).collect();
        counts.sort_unstable();
        let mut left = points.saturating_mul(LEVELS);
        let within = counts.iter().take_while(|&&count| {
            let fits = count <= left;
            left = left.saturating_sub(count);
            fits
        });
        within.last().copied().unwrap_or(0)
    }

    /// Puts a volume around the items of every box.
    fn fit(&mut self) {
        let points = self.local_points();
        let most = self.most_points(points.len());
        // The root has all points: what is fitted to them all asks for no boxes.
        let bounds = if most < points.len() { self.bounds(&points) } else { Vec::new() };
        let around = |i: usize| {
            let own = self.points_of(self.items[i]);
            if own.len() <= most { V::around(&points[own]) } else { V::around(&bounds[i].corners()) }
        };
        if self.is_empty() {
            return;
        }
        let root = around(0);
        let boxes = self.links.iter().enumerate();
        self.volumes =
            boxes.map(|(i, link)| if i > 0 && link.is_used() { around(i) } else { root }).collect();
        self.blocks = vec![V::Eight::UNUSED; self.links.len() / BLOCK];
        for (i, (volume, link)) in self.volumes.iter().zip(&mut self.links).enumerate() {
            if link.is_used() {
                link.surface = volume.surface();
                self.blocks[i / BLOCK].set(i % BLOCK, volume);
            }
        }
    }

    /// How it is shaped.
    pub fn statistics(&self) -> VolumeTreeStatistics {
        let used = || (0..self.links.len()).filter(|&i| self.links[i].is_used());
        let mut depths = vec![0; self.links.len()];
        let (mut depth, mut own, mut aligned) = (0, 0.0, 0.0);
        let bounds = self.bounds(&self.local_points());
        for i in used() {
            depths[i] = depths[i].max(1);
            depth = depth.max(depths[i]);
            let link = self.links[i];
            if !link.is_leaf() {
                (link.first..link.first + link.count())
                    .for_each(|below| depths[below as usize] = depths[i] + 1);
            }
            own += f64::from(link.surface);
            aligned += f64::from(Overlap::surface(&bounds[i]));
        }
        VolumeTreeStatistics {
            boxes: used().count(),
            leaves: used().filter(|&i| self.links[i].is_leaf()).count(),
            depth,
            tightness: if aligned > 0.0 { own / aligned } else { 1.0 },
            bytes: self.links.len()
                * (size_of::<V>() + size_of::<Link>() + size_of::<V::Eight>() / BLOCK + 8)
                + size_of_val(self.order.as_slice())
                + size_of_val(self.triangles())
                + size_of_val(self.corners()),
        }
    }

    /// Checks that every item lies in one leaf, every box's items in those of the box above, and that no volume is
    /// certainly apart from a point of its own.
    ///
    /// # Errors
    /// [`TreeError`]: the first box of which that is not so.
    pub fn validate(&self) -> Result<(), TreeError> {
        let mut seen = vec![0_u32; self.order.len()];
        let mut stack: Vec<usize> = if self.is_empty() { Vec::new() } else { vec![0] };
        let all = self.local_points();
        let (bounds, most) = (self.bounds(&all), self.most_points(all.len()));
        let here = Way::new(&Rigid::IDENTITY, 0.0);
        while let Some(i) = stack.pop() {
            let (link, (first, end)) = (self.links[i], self.items[i]);
            if link.is_leaf() {
                if (link.first, link.first + link.count()) != (first, end) {
                    return Err(TreeError::new(i, "a leaf whose items are not its own"));
                }
                seen[first as usize..end as usize].iter_mut().for_each(|times| *times += 1);
            } else {
                let below = link.first as usize..(link.first + link.count()) as usize;
                let mut at = first;
                for child in below {
                    let Some(&(from, to)) = self.items.get(child) else {
                        return Err(TreeError::new(i, format!("box {child} below is not there")));
                    };
                    if from != at || to <= from {
                        return Err(TreeError::new(
                            child,
                            format!("items {from} to {to}, expected from {at} on"),
                        ));
                    }
                    at = to;
                    stack.push(child);
                }
                if at != end {
                    return Err(TreeError::new(i, format!("items up to {end}, the boxes below end at {at}")));
                }
            }
            // Of more points than it was fitted to each of, the box around them: all volumes are convex.
            let corners = bounds[i].corners();
            let own = self.points_of((first, end));
            let points = if own.len() <= most { &all[own] } else { &corners[..] };
            let around = self.volumes[i].moved(&here);
            if points.iter().any(|point| V::around(&[*point]).apart(&around)) {
                return Err(TreeError::new(i, "a point of its own lies outside"));
            }
        }
        match seen.iter().position(|&times| times != 1) {
            Some(item) => {
                Err(TreeError::new(0, format!("item at place {item} lies in {} leaves", seen[item])))
            }
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests;
