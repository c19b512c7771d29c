//! Where processors write pixels.

use crate::machine::{Layout, Machine, Shared, Slot};

use super::Image;

/// The most pixels a picture may have.
pub const MOST_PIXELS: u64 = 1 << 28;

/// The pixels of a picture in a machine's shared memory, row by row: linear red, green and blue.
pub struct Film<M: Machine> {
    width: u32,
    height: u32,
    pixels: Shared<M::Slot<[f32; 3]>>,
}

impl<M: Machine> Film<M> {
    /// A black film of so many pixels across and down; none without a pixel or with more than [`MOST_PIXELS`].
    pub fn new(machine: &M, width: u32, height: u32) -> Option<Self> {
        let count = u64::from(width) * u64::from(height);
        let pixels = || machine.alloc(count as usize, Layout::Packed, |_| Slot::new([0.0; 3]));
        (1..=MOST_PIXELS).contains(&count).then(|| Self { width, height, pixels: pixels() })
    }

    /// Pixels across and down.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Where a pixel lies.
    pub(super) fn slot(&self, x: u32, y: u32) -> &M::Slot<[f32; 3]> {
        &self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// What the last run left. `&mut`, for no run may be going on.
    pub fn image(&mut self) -> Image {
        let pixels = self.pixels.iter().map(|slot| {
            // SAFETY: a run borrows the film, so none is going on.
            unsafe { slot.read() }
        });
        Image { width: self.width, height: self.height, pixels: pixels.collect() }
    }
}
