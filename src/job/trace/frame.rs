//! A picture as independent pieces.

use std::ops::Range;

use crate::machine::{Machine, Processor, Slot};
use crate::scheme::tiles::TileWork;

use super::film::Claim;
use super::waves::Waves;
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

/// Pixels across and down whose rays come one after the other: as many as go in a packet, and as near one another as
/// can be.
const SQUARE: usize = 4;
/// The most pixels whose rays are asked about together: the more, the more of them meet the same, until they no longer
/// fit into the nearest caches.
const TOGETHER: usize = 512;

/// The picture of one camera, for a tile scheme to share out.
pub struct Frame<'a, M: Machine> {
    tracer: Tracer<'a>,
    eye: Eye,
    tiles: Tiles,
    film: &'a Film<M>,
    /// What each tile is charged on a simulated machine; natively they take their time.
    costs: Option<&'a TileCosts>,
    /// What is known of it beforehand.
    draft: Option<&'a Draft>,
}

/// A picture of which part is known before it is traced: the pixels that are taken as they are.
#[derive(Clone, Debug)]
pub struct Draft {
    width: usize,
    /// Colours and distances, as a [`Film`] holds them; a distance of NaN says that a pixel is not known.
    pixels: Vec<[f32; 4]>,
}

impl Draft {
    /// Nothing is known of any of so many pixels across and down.
    pub fn new((width, height): (u32, u32)) -> Self {
        let count = width as usize * height as usize;
        Self { width: width as usize, pixels: vec![[f32::NAN; 4]; count] }
    }

    /// What is known of a pixel: its colour and distance.
    pub fn known(&self, x: u32, y: u32) -> Option<[f32; 4]> {
        let pixel = self.pixels[y as usize * self.width + x as usize];
        (!pixel[3].is_nan()).then_some(pixel)
    }

    /// Takes a pixel for known.
    pub fn set(&mut self, x: u32, y: u32, pixel: [f32; 4]) {
        self.pixels[y as usize * self.width + x as usize] = pixel;
    }
}

impl<'a, M: Machine> Frame<'a, M> {
    /// A picture as large as the film, which it has to itself.
    ///
    /// # Panics
    /// If the camera is before a picture of another size.
    pub fn new(tracer: Tracer<'a>, eye: Eye, tile: (u32, u32), film: &'a mut Film<M>) -> Self {
        assert_eq!(eye.size(), film.size(), "the camera is before this very picture");
        let tiles = Tiles::new(film.size(), tile);
        film.cut(tiles.count());
        Self { tracer, eye, tiles, film, costs: None, draft: None }
    }

    /// The same, each tile charged what it was measured to cost.
    ///
    /// # Panics
    /// If the costs are not those of as many tiles.
    pub fn charged(self, costs: &'a TileCosts) -> Self {
        assert_eq!(costs.len(), self.tiles.count(), "a cost for each tile");
        Self { costs: Some(costs), ..self }
    }

    /// The same, of which the pixels that are known need not be traced.
    ///
    /// # Panics
    /// If the draft is of another size.
    pub fn drafted(self, draft: &'a Draft) -> Self {
        let (width, height) = self.film.size();
        let size = (draft.width, draft.pixels.len());
        assert_eq!(size, (width as usize, width as usize * height as usize), "a draft of this very picture");
        Self { draft: Some(draft), ..self }
    }

    /// How the picture is cut.
    pub fn tiles(&self) -> Tiles {
        self.tiles
    }

    /// Traces one tile.
    ///
    /// # Panics
    /// If another processor is at this tile.
    pub(super) fn trace(&self, tile: usize, counts: &mut Counts) {
        let claim = self.film.claim(tile);
        Waves::lent(|waves| self.trace_claimed(&claim, tile, waves, counts));
    }

    fn trace_claimed(&self, claim: &Claim<'_>, tile: usize, waves: &mut Waves, counts: &mut Counts) {
        let (across, down) = self.tiles.pixels(tile);
        let squares = down.clone().step_by(SQUARE).flat_map(|top| {
            let lefts = across.clone().step_by(SQUARE);
            lefts.map(move |left| (left, top))
        });
        let mut pixels = [(0, 0); TOGETHER];
        let mut count = 0;
        for (left, top) in squares {
            if count + SQUARE * SQUARE > TOGETHER {
                self.trace_pixels(claim, &pixels[..count], waves, counts);
                count = 0;
            }
            for y in top..down.end.min(top + SQUARE as u32) {
                for x in left..across.end.min(left + SQUARE as u32) {
                    if let Some(known) = self.draft.and_then(|draft| draft.known(x, y)) {
                        self.write(claim, (x, y), known);
                        continue;
                    }
                    pixels[count] = (x, y);
                    count += 1;
                }
            }
        }
        self.trace_pixels(claim, &pixels[..count], waves, counts);
    }

    /// Writes a pixel of a claimed tile: its colour and distance.
    fn write(&self, _claim: &Claim<'_>, (x, y): (u32, u32), pixel: [f32; 4]) {
        // SAFETY: the claim keeps everybody else from this tile, and the pixels of others are not written. What the last
        // to have the tile wrote happened before the claim.
        unsafe { self.film.slot(x, y).write(pixel) };
    }

    /// Traces some pixels of a claimed tile, not more than are asked about together.
    fn trace_pixels(&self, claim: &Claim<'_>, pixels: &[(u32, u32)], waves: &mut Waves, counts: &mut Counts) {
        let rays = pixels.iter().map(|(x, y)| self.eye.ray(*x, *y));
        for (place, (colour, far)) in pixels.iter().zip(waves.seen(&self.tracer, rays, counts)) {
            let [r, g, b] = colour.to_array();
            self.write(claim, *place, [r, g, b, far]);
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

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::Barrier;

    use glam::Vec3;

    use super::super::{Look, World};
    use super::*;
    use crate::geometry::{Camera, Hit, Lens, Ray};
    use crate::machine::Threads;
    use crate::scene::Scene;
    use crate::structure::bvh::Intersector;

    /// Meets nothing, and keeps who asks about rays together for as long as others take.
    struct Slow {
        asked: Barrier,
        answer: Barrier,
    }

    impl Intersector for Slow {
        fn closest(&self, _: &Ray) -> Option<Hit> {
            None
        }
        fn occluded(&self, _: &Ray) -> bool {
            false
        }
        fn closest_coherent(&self, _: &[Ray], _: &mut [Option<Hit>]) {
            self.asked.wait();
            self.answer.wait();
        }
    }

    /// Breaks down.
    struct Broken;

    impl Intersector for Broken {
        fn closest(&self, _: &Ray) -> Option<Hit> {
            panic!("it broke down")
        }
        fn occluded(&self, _: &Ray) -> bool {
            false
        }
    }

    fn eye() -> Eye {
        let lens = Lens::Symmetric { fov_y: 0.8, aspect: 2.0 };
        Eye::new(&Camera::look_at(Vec3::ZERO, Vec3::Z, Vec3::Y, lens, 0.1, 10.0).unwrap(), 8, 4)
    }

    #[test]
    fn who_takes_a_tile_that_another_is_at_is_stopped() {
        let world = World::new(Scene::new("nothing"));
        let slow = Slow { asked: Barrier::new(2), answer: Barrier::new(2) };
        let threads = Threads::new(1).unwrap();
        let mut film = Film::new(&threads, 8, 4).unwrap();
        let frame = Frame::new(Tracer::new(&world, &slow, Look::default()), eye(), (4, 4), &mut film);
        let trace = &|processor: usize, tile: usize| {
            let mut counts = Counts::default();
            frame.work_on(tile..tile + 1, &mut counts, &threads.outside(processor, 3));
            counts.eye
        };
        std::thread::scope(|scope| {
            let first = scope.spawn(move || trace(0, 0));
            slow.asked.wait();
            let stopped = catch_unwind(AssertUnwindSafe(|| trace(1, 0))).unwrap_err();
            let message = stopped.downcast_ref::<String>().unwrap();
            assert!(message.contains("tile 0 is being traced already"), "{message}");
            slow.answer.wait();
            assert_eq!(first.join().unwrap(), 16);
            // Free again, and the other never was taken.
            for tile in [0, 1] {
                let next = scope.spawn(move || trace(2, tile));
                slow.asked.wait();
                slow.answer.wait();
                assert_eq!(next.join().unwrap(), 16);
            }
        });
    }

    #[test]
    fn a_tile_whose_tracing_broke_down_is_free_again() {
        let world = World::new(Scene::new("nothing"));
        let threads = Threads::new(1).unwrap();
        let mut film = Film::new(&threads, 8, 4).unwrap();
        let frame = Frame::new(Tracer::new(&world, &Broken, Look::default()), eye(), (8, 4), &mut film);
        for _ in 0..2 {
            let broke =
                catch_unwind(AssertUnwindSafe(|| frame.trace(0, &mut Counts::default()))).unwrap_err();
            assert_eq!(broke.downcast_ref::<&str>(), Some(&"it broke down"));
        }
    }
}
