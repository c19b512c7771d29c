//! A picture as independent pieces.

use std::ops::Range;

use crate::geometry::{Hit, Ray};
use crate::machine::{Machine, Processor, Slot};
use crate::scheme::tiles::TileWork;

use super::{Counts, Eye, Film, TileCosts, Tracer};

/// A picture cut into tiles, numbered row by row; those at its right and lower edge may be smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tiles {
    size: (u32, u32),
    tile: (u32, u32),
}

impl Tiles {
    /// Of Parker et al. sec. 2.1, in pixels across and down: a row of a tile is 128 bytes there, a line of the
    /// Origin's caches.
    pub const OF_PAPER: (u32, u32) = (32, 4);

    /// The most pixels a tile may have across or down.
    pub const MOST: u32 = 1024;

    /// Tiles of so many pixels across and down, kept between 1 and [`Tiles::MOST`].
    pub fn new(size: (u32, u32), tile: (u32, u32)) -> Self {
        Self { size, tile: (tile.0.clamp(1, Self::MOST), tile.1.clamp(1, Self::MOST)) }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.across() * self.size.1.div_ceil(self.tile.1) as usize
    }

    fn across(&self) -> usize {
        self.size.0.div_ceil(self.tile.0) as usize
    }

    /// The pixels of a tile: from which to which across, and down.
    pub fn pixels(&self, tile: usize) -> (Range<u32>, Range<u32>) {
        let (column, row) = (tile % self.across(), tile / self.across());
        let range = |at: usize, tile: u32, size: u32| {
            let start = at as u32 * tile;
            start..size.min(start.saturating_add(tile))
        };
        (range(column, self.tile.0, self.size.0), range(row, self.tile.1, self.size.1))
    }
}

/// The picture of one camera, for a tile scheme to share out.
pub struct Frame<'a, M: Machine> {
    tracer: Tracer<'a>,
    eye: Eye,
    tiles: Tiles,
    film: &'a Film<M>,
    /// What each tile is charged on a simulated machine; natively they take their time.
    costs: Option<&'a TileCosts>,
}

impl<'a, M: Machine> Frame<'a, M> {
    /// A picture as large as the film.
    pub fn new(tracer: Tracer<'a>, eye: Eye, tile: (u32, u32), film: &'a Film<M>) -> Self {
        assert_eq!(eye.size(), film.size(), "the camera is before this very picture");
        Self { tracer, eye, tiles: Tiles::new(film.size(), tile), film, costs: None }
    }

    /// The same, each tile charged what it was measured to cost.
    ///
    /// # Panics
    /// If the costs are not those of as many tiles.
    pub fn charged(self, costs: &'a TileCosts) -> Self {
        assert_eq!(costs.len(), self.tiles.count(), "a cost for each tile");
        Self { costs: Some(costs), ..self }
    }

    /// How the picture is cut.
    pub fn tiles(&self) -> Tiles {
        self.tiles
    }

    /// Traces one tile.
    pub(super) fn trace(&self, tile: usize, counts: &mut Counts) {
        let (across, down) = self.tiles.pixels(tile);
        let pixels = || down.clone().flat_map(|y| across.clone().map(move |x| (x, y)));
        let rays: Vec<Ray> = pixels().map(|(x, y)| self.eye.ray(x, y)).collect();
        let mut hits: Vec<Option<Hit>> = vec![None; rays.len()];
        self.tracer.intersector().closest_coherent(&rays, &mut hits);
        counts.eye += rays.len() as u64;
        for (((x, y), ray), hit) in pixels().zip(&rays).zip(hits) {
            let colour = self.tracer.seen(ray, hit, counts);
            // SAFETY: no other processor works on this tile, and the pixels of others are not written.
            unsafe { self.film.slot(x, y).write(colour.to_array()) };
        }
    }
}

impl<M: Machine> TileWork for Frame<'_, M> {
    type Found = Counts;

    fn pieces(&self) -> usize {
        self.tiles.count()
    }

    fn found(&self) -> Counts {
        Counts::default()
    }

    fn work_on<P: Processor>(&self, pieces: Range<usize>, found: &mut Counts, cpu: &P) {
        for tile in pieces {
            self.trace(tile, found);
            if let Some(costs) = self.costs {
                cpu.charge(costs.cycles(tile));
            }
        }
    }
}
