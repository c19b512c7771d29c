//! Rays by themselves: sets of one kind, followed to what they meet first, with nothing seen and nothing drawn. What a
//! hierarchy is worth is told by how many it follows a second (Ize ch. 7, Table 7.1).

mod sets;

use crate::geometry::{Hit, Ray};
use crate::machine::Processor;
use crate::scheme::tiles::TileWork;
use crate::structure::bvh::Intersector;
pub use sets::{KINDS, RayKind, ray_set};
use std::ops::Range;

/// Rays in a piece: enough that handing one out costs little beside it.
pub const PIECE: usize = 256;

/// How rays are asked about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// What each meets first, one by one.
    Closest,
    /// What each meets first, those of a piece together.
    Coherent,
    /// Whether it meets anything.
    Any,
}

/// A set of rays as independent pieces.
pub struct RayWork<'a> {
    /// What answers for them.
    pub intersector: &'a dyn Intersector,
    /// All rays.
    pub rays: &'a [Ray],
    /// What is asked.
    pub asked: Asked,
}

/// What rays came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Met {
    /// Rays that met something.
    pub hits: u64,
    /// Of which items and how far off, each ray by its number: the same for the same hits, in any order.
    pub mark: u64,
}

impl Met {
    fn add(&mut self, ray: usize, hit: Option<Hit>) {
        let Some(hit) = hit else { return };
        self.hits += 1;
        let mark = (ray as u64) << 32 ^ u64::from(hit.item) ^ u64::from(hit.t.to_bits()).rotate_left(32);
        // Spread, so that no two differences cancel by accident (the finalizer of SplitMix64).
        let mark = (mark ^ (mark >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        self.mark = self.mark.wrapping_add((mark ^ (mark >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB));
    }
}

impl std::ops::AddAssign for Met {
    fn add_assign(&mut self, other: Self) {
        self.hits += other.hits;
        self.mark = self.mark.wrapping_add(other.mark);
    }
}

impl TileWork for RayWork<'_> {
    type Found = Met;

    fn pieces(&self) -> usize {
        self.rays.len().div_ceil(PIECE)
    }

    fn found(&self) -> Met {
        Met::default()
    }

    fn work_on<P: Processor>(&self, pieces: Range<usize>, found: &mut Met, _cpu: &P) {
        let start = pieces.start * PIECE;
        let rays = &self.rays[start..self.rays.len().min(pieces.end * PIECE)];
        match self.asked {
            Asked::Closest => {
                let hits = rays.iter().map(|ray| self.intersector.closest(ray));
                hits.enumerate().for_each(|(at, hit)| found.add(start + at, hit));
            }
            Asked::Coherent => {
                let mut hits = [None; PIECE];
                for (number, rays) in rays.chunks(PIECE).enumerate() {
                    let hits = &mut hits[..rays.len()];
                    self.intersector.closest_coherent(rays, hits);
                    let hits = hits.iter().enumerate();
                    hits.for_each(|(at, hit)| found.add(start + number * PIECE + at, *hit));
                }
            }
            Asked::Any => {
                found.hits += rays.iter().filter(|ray| self.intersector.occluded(ray)).count() as u64
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::trace::{List, World};
    use crate::machine::Threads;
    use crate::scene::by_name;
    use crate::scheme::tiles::{SCHEMES, share};

    #[test]
    fn every_scheme_and_way_of_asking_finds_the_same() {
        let world = World::new(by_name("robot").unwrap());
        let list = List(world.items());
        let team = Threads::new(3).unwrap();
        for kind in KINDS {
            let rays = ray_set(kind.kind, world.scene(), &list, 600, 1).unwrap();
            let met = |scheme: &str, asked| {
                let work = RayWork { intersector: &list, rays: &rays, asked };
                let mut all = Met::default();
                share(scheme, &team, 3, &work).unwrap().iter().for_each(|share| all += share.found);
                all
            };
            let expected = met("serial", Asked::Closest);
            for scheme in SCHEMES {
                assert_eq!(met(scheme.name, Asked::Closest), expected, "{} {}", kind.name, scheme.name);
                assert_eq!(met(scheme.name, Asked::Coherent), expected, "{} {}", kind.name, scheme.name);
                assert_eq!(met(scheme.name, Asked::Any).hits, expected.hits, "{} {}", kind.name, scheme.name);
            }
        }
    }
}
