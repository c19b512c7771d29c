//! Fewer pixels, between which the others are interpolated.

use super::{About, Knob, Method};
use crate::job::trace::Image;

pub(super) const ABOUT: About = About {
    name: "lower_resolution",
    summary: "fewer pixels are traced, and the others interpolated between them",
    knob: Knob {
        about: "pixels shown, across and down, for one traced",
        default: 2.0,
        least: 1.0,
        most: 64.0,
    },
    make: |times| Box::new(LowerResolution { times }),
};

struct LowerResolution {
    times: f64,
}

impl Method for LowerResolution {
    fn traced(&self, (width, height): (u32, u32)) -> (u32, u32) {
        let less = |pixels: u32| ((f64::from(pixels) / self.times).ceil() as u32).max(1);
        (less(width), less(height))
    }

    fn shown(&self, traced: &mut dyn FnMut() -> Image, size: (u32, u32)) -> Option<Image> {
        let traced = traced();
        ((traced.width, traced.height) != size).then(|| larger(&traced, size))
    }
}

/// The picture with so many pixels across and down, each between the four about it (bilinear; at the edge, the last
/// ones go on).
fn larger(image: &Image, (width, height): (u32, u32)) -> Image {
    let steps = |from: u32, to: u32| -> Vec<(usize, usize, f32)> {
        let last = from as usize - 1;
        let place = |at: u32| (f64::from(at) + 0.5) * f64::from(from) / f64::from(to) - 0.5;
        let step = |at: u32| {
            let place = place(at).clamp(0.0, last as f64);
            let low = place as usize;
            (low, (low + 1).min(last), (place - low as f64) as f32)
        };
        (0..to).map(step).collect()
    };
    let (across, down) = (steps(image.width, width), steps(image.height, height));
    let mut pixels = Vec::with_capacity(across.len() * down.len());
    for (upper, lower, share_down) in down {
        let row = |row: usize| &image.pixels[row * image.width as usize..][..image.width as usize];
        let (upper, lower) = (row(upper), row(lower));
        pixels.extend(across.iter().map(|&(left, right, share)| {
            std::array::from_fn(|colour| {
                let between =
                    |row: &[[f32; 3]]| row[left][colour] * (1.0 - share) + row[right][colour] * share;
                between(upper) * (1.0 - share_down) + between(lower) * share_down
            })
        }));
    }
    Image { width, height, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_even_stays_so_and_a_slope_stays_one() {
        let image = |width: u32, height: u32, colour: fn(u32, u32) -> f32| {
            let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [colour(x, y), 0.5, 1.0]));
            Image { width, height, pixels: pixels.collect() }
        };
        let even = image(3, 2, |_, _| 0.25);
        for size in [(7, 5), (6, 4), (3, 2), (1, 1)] {
            let found = larger(&even, size);
            assert_eq!((found.width, found.height), size);
            assert!(found.pixels.iter().all(|pixel| *pixel == [0.25, 0.5, 1.0]), "{size:?}");
        }
        let slope = larger(&image(10, 1, |x, _| x as f32 + 0.5), (40, 3));
        for (at, pixel) in slope.pixels.iter().enumerate() {
            let x = (at % 40) as f32;
            let expected = ((x + 0.5) / 4.0).clamp(0.5, 9.5);
            assert!((pixel[0] - expected).abs() < 1e-5, "{at}: {pixel:?}, not {expected}");
        }
    }
}
