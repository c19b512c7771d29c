//! Where processors write pixels.

use std::sync::atomic::Ordering;

use crate::machine::threads::NativeWord;
use crate::machine::{Layout, Machine, Shared, Slot, Word};

use super::Image;

/// The most pixels a picture may have.
pub const MOST_PIXELS: u64 = 1 << 28;

/// The pixels of a picture in a machine's shared memory, row by row: linear red, green and blue, and how far off what is
/// seen there is, in metres; infinitely where nothing is.
pub struct Film<M: Machine> {
    width: u32,
    height: u32,
    pixels: Shared<M::Slot<[f32; 4]>>,
    /// For each tile of the picture being made, 1 while somebody is at it. Native on every machine: that no two
    /// processors are at one tile is what a scheme promises, so a simulated machine is not to pay for the check.
    claims: Vec<NativeWord>,
}

impl<M: Machine> Film<M> {
    /// A black film of so many pixels across and down; none without a pixel or with more than [`MOST_PIXELS`].
    pub fn new(machine: &M, width: u32, height: u32) -> Option<Self> {
        let count = u64::from(width) * u64::from(height);
        let pixels = || machine.alloc(count as usize, Layout::Packed, |_| Slot::new([0.0; 4]));
        let made = || Self { width, height, pixels: pixels(), claims: Vec::new() };
        (1..=MOST_PIXELS).contains(&count).then(made)
    }

    /// Pixels across and down.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Makes ready for a picture of so many tiles. `&mut`, for no picture may be going on.
    pub(super) fn cut(&mut self, tiles: usize) {
        self.claims.resize_with(tiles, || NativeWord::new(0));
    }

    /// Takes a tile until what is told is dropped.
    ///
    /// # Panics
    /// If somebody has it.
    pub(super) fn claim(&self, tile: usize) -> Claim<'_> {
        let claim = &self.claims[tile];
        // ORDERING: Acquire pairs with the Release in `Claim::drop`: whoever had the tile before has written its pixels.
        let had = claim.swap(1, Ordering::Acquire);
        assert!(had == 0, "tile {tile} is being traced already");
        Claim(claim)
    }

    /// Where a pixel lies.
    pub(super) fn slot(&self, x: u32, y: u32) -> &M::Slot<[f32; 4]> {
        &self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// What the last run left: colours and distances. `&mut`, for no run may be going on.
    pub fn pixels(&mut self) -> impl Iterator<Item = [f32; 4]> {
        self.pixels.iter().map(|slot| {
            // SAFETY: a picture being made borrows the film mutably, so none is.
            unsafe { slot.read() }
        })
    }

    /// The picture that the last run left. `&mut`, for no run may be going on.
    pub fn image(&mut self) -> Image {
        let (width, height) = self.size();
        Image { width, height, pixels: self.pixels().map(|[r, g, b, _]| [r, g, b]).collect() }
    }
}

/// A tile that somebody has.
pub(super) struct Claim<'a>(&'a NativeWord);

impl Drop for Claim<'_> {
    fn drop(&mut self) {
        // ORDERING: Release pairs with the Acquire in `Film::claim`.
        self.0.store(0, Ordering::Release);
    }
}
