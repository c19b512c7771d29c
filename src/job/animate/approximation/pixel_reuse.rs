//! Some pixels stay as they were in the frame before (P3-A01; the paper's example, Fig. 5, keeps every fourth).

use super::turns::{PARTS, has_turn};
use super::{About, Knob, Method, Seen};
use crate::job::trace::{Draft, Eye};

pub(super) const ABOUT: About = About {
    name: "pixel_reuse",
    summary: "some pixels stay as they were in the frame before",
    knob: Knob { about: "sixteenths of the pixels that stay", default: 4.0, least: 0.0, most: 15.0 },
    make: |stay| Box::new(PixelReuse { traced: PARTS - stay as u32 }),
};

struct PixelReuse {
    /// Parts of the picture that are traced.
    traced: u32,
}

impl Method for PixelReuse {
    fn looks_back(&self) -> bool {
        true
    }

    fn draft(&self, eye: &Eye, number: u32, before: &Seen) -> Option<Draft> {
        let (width, height) = eye.size();
        let mut draft = Draft::new((width, height));
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            if !has_turn((x, y), number, self.traced) {
                draft.set(x, y, before.pixel(x, y));
            }
        }
        Some(draft)
    }
}
