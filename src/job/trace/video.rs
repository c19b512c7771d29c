//! Pictures that follow one another as a file: YUV4MPEG2, what encoders and players take without being told anything
//! (its description: the manual yuv4mpeg(5) of the mjpegtools).
//!
//! Brightness is told for each pixel, colour for each square of two by two (4:2:0): the one layout that every encoder
//! takes. Numbers run over the part of 8 bits that is meant for pictures, 16 to 235 and 240.

use std::io::{self, Write};

use super::Image;

/// Pictures a second, as a fraction, for that is what a file tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRate {
    /// Pictures.
    pub pictures: u32,
    /// In so many seconds.
    pub seconds: u32,
}

impl FrameRate {
    /// What is taken where no time goes by.
    pub const USUAL: Self = Self { pictures: 25, seconds: 1 };

    /// That of so many pictures from the first to the last of which so many seconds go by; [`FrameRate::USUAL`] where
    /// that tells none: of a single picture, of no time, of one that is not finite, or of one too long or short for a
    /// fraction to tell.
    pub fn of(pictures: u32, seconds: f64) -> Self {
        // A millisecond more or less of a whole animation nobody sees.
        let (steps, thousandths) = (u64::from(pictures.saturating_sub(1)) * 1000, (seconds * 1000.0).round());
        if steps == 0 || !(1.0..=f64::from(u32::MAX)).contains(&thousandths) {
            return Self::USUAL;
        }
        let thousandths = thousandths as u64;
        let common = common_divisor(steps, thousandths);
        let [pictures, seconds] = [steps, thousandths].map(|part| u32::try_from(part / common));
        pictures.ok().zip(seconds.ok()).map_or(Self::USUAL, |(pictures, seconds)| Self { pictures, seconds })
    }
}

fn common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

/// How much of red and of blue there is in brightness; the rest is green.
#[derive(Clone, Copy, Debug)]
struct Weights {
    red: f64,
    blue: f64,
}

/// Of small pictures (ITU-R BT.601), and of large ones (BT.709). A file does not say which: players go by its size, and
/// so does this.
const SMALL: Weights = Weights { red: 0.299, blue: 0.114 };
const LARGE: Weights = Weights { red: 0.2126, blue: 0.0722 };

impl Weights {
    fn of(width: u32, height: u32) -> Self {
        if width >= 1280 || height > 576 { LARGE } else { SMALL }
    }

    /// Brightness, and how far blue and red are from it, from codes of a colour in 8 bits: from 0 to 1, and from -1/2
    /// to 1/2.
    fn apart(self, pixel: [u8; 3]) -> [f64; 3] {
        let [red, green, blue] = pixel.map(|code| f64::from(code) / 255.0);
        let bright = self.red * red + (1.0 - self.red - self.blue) * green + self.blue * blue;
        let far = |colour: f64, weight: f64| (colour - bright) / (2.0 - 2.0 * weight);
        [bright, far(blue, self.blue), far(red, self.red)]
    }
}

/// A film being written.
pub struct Video<'a> {
    out: &'a mut dyn Write,
    size: (u32, u32),
    weights: Weights,
}

impl<'a> Video<'a> {
    /// Begins a film of pictures of so many pixels across and down.
    ///
    /// # Errors
    /// What `out` says.
    pub fn new(out: &'a mut dyn Write, size: (u32, u32), rate: FrameRate) -> io::Result<Self> {
        let ((width, height), FrameRate { pictures, seconds }) = (size, rate);
        // Whole pictures (Ip), square pixels (A1:1), colour taken in the middle of its four pixels (C420jpeg). The last
        // word is known to some readers, and a comment to all others.
        writeln!(
            out,
            "YUV4MPEG2 W{width} H{height} F{pictures}:{seconds} Ip A1:1 C420jpeg XCOLORRANGE=LIMITED"
        )?;
        Ok(Self { out, size, weights: Weights::of(width, height) })
    }

    /// Adds a picture, its colours coded as sRGB.
    ///
    /// # Errors
    /// What `out` says.
    ///
    /// # Panics
    /// If it is of another size than the film.
    pub fn add(&mut self, image: &Image) -> io::Result<()> {
        assert_eq!((image.width, image.height), self.size, "all pictures of a film are of one size");
        let codes = image.codes();
        let (pixels, _) = codes.as_chunks::<3>();
        let apart: Vec<[f64; 3]> = pixels.iter().map(|pixel| self.weights.apart(*pixel)).collect();
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let mut bytes = b"FRAME\n".to_vec();
        bytes.extend(apart.iter().map(|[bright, ..]| (16.0 + 219.0 * bright).round() as u8));
        for part in [1, 2] {
            for (top, left) in
                (0..height).step_by(2).flat_map(|top| (0..width).step_by(2).map(move |left| (top, left)))
            {
                // At the edge of an odd size there are two, or one.
                let rows = top..height.min(top + 2);
                let four = rows.flat_map(|y| (left..width.min(left + 2)).map(move |x| y * width + x));
                let (sum, count) =
                    four.fold((0.0, 0.0), |(sum, count), at| (sum + apart[at][part], count + 1.0));
                bytes.push((128.0 + 224.0 * sum / count).round() as u8);
            }
        }
        self.out.write_all(&bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of given codes: what linear colours they stand for.
    fn picture(width: u32, height: u32, code: impl Fn(u32, u32) -> [u8; 3]) -> Image {
        let linear = |code: u8| {
            let coded = f64::from(code) / 255.0;
            let linear = if coded <= 0.04045 { coded / 12.92 } else { ((coded + 0.055) / 1.055).powf(2.4) };
            linear as f32
        };
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Image { width, height, pixels: pixels.map(|(x, y)| code(x, y).map(linear)).collect() }
    }

    /// The planes of a film of one picture.
    fn planes(image: &Image) -> [Vec<u8>; 3] {
        let mut bytes = Vec::new();
        let mut film = Video::new(&mut bytes, (image.width, image.height), FrameRate::USUAL).unwrap();
        film.add(image).unwrap();
        let head = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
        let body = bytes[head..].strip_prefix(b"FRAME\n").unwrap();
        let bright = (image.width * image.height) as usize;
        let colour = (image.width.div_ceil(2) * image.height.div_ceil(2)) as usize;
        assert_eq!(body.len(), bright + 2 * colour);
        let (y, rest) = body.split_at(bright);
        [y.to_vec(), rest[..colour].to_vec(), rest[colour..].to_vec()]
    }

    #[test]
    fn pure_colours_have_the_standards_numbers() {
        // Of the colour bars at full strength, as tables of both standards print them.
        let small = [
            ([255, 255, 255], [235, 128, 128]),
            ([0, 0, 0], [16, 128, 128]),
            ([255, 0, 0], [81, 90, 240]),
            ([0, 255, 0], [145, 54, 34]),
            ([0, 0, 255], [41, 240, 110]),
            ([128, 128, 128], [126, 128, 128]),
        ];
        let large = [
            ([255, 255, 255], [235, 128, 128]),
            ([0, 0, 0], [16, 128, 128]),
            ([255, 0, 0], [63, 102, 240]),
            ([0, 255, 0], [173, 42, 26]),
            ([0, 0, 255], [32, 240, 118]),
            ([255, 255, 0], [219, 16, 138]),
        ];
        for (size, table) in [((4, 2), small), ((1280, 2), large), ((2, 577), large)] {
            for (code, expected) in table {
                let found = planes(&picture(size.0, size.1, |_, _| code));
                for (plane, expected) in found.iter().zip(expected) {
                    assert!(plane.iter().all(|byte| *byte == expected), "{size:?} {code:?}: {}", plane[0]);
                }
            }
        }
        for (size, expected) in [((1279, 576), SMALL), ((1280, 1), LARGE), ((1, 577), LARGE)] {
            assert_eq!(Weights::of(size.0, size.1).red, expected.red, "{size:?}");
        }
    }

    #[test]
    fn four_pixels_share_a_colour_and_those_at_an_odd_edge_are_fewer() {
        let red_left = picture(3, 3, |x, _| if x == 0 { [255, 0, 0] } else { [0, 0, 0] });
        let [y, u, v] = planes(&red_left);
        assert_eq!(y, [81, 16, 16, 81, 16, 16, 81, 16, 16]);
        // Half of red and half of black, and at the right edge black alone.
        assert_eq!(u, [109, 128, 109, 128]);
        assert_eq!(v, [184, 128, 184, 128]);
    }

    #[test]
    fn the_head_tells_size_and_rate_and_each_picture_begins_with_its_word() {
        let mut bytes = Vec::new();
        let mut film = Video::new(&mut bytes, (2, 2), FrameRate { pictures: 4995, seconds: 98 }).unwrap();
        film.add(&picture(2, 2, |_, _| [1, 2, 3])).unwrap();
        film.add(&picture(2, 2, |_, _| [200, 2, 3])).unwrap();
        let head = b"YUV4MPEG2 W2 H2 F4995:98 Ip A1:1 C420jpeg XCOLORRANGE=LIMITED\n";
        let body = bytes.strip_prefix(head).unwrap();
        assert_eq!(body.len(), 2 * (6 + 6));
        assert!(body.chunks(12).all(|picture| picture.starts_with(b"FRAME\n")));
        let odd = Image { width: 1, height: 1, pixels: vec![[f32::NAN, -1.0, 9.0]] };
        assert_eq!(planes(&odd), planes(&picture(1, 1, |_, _| [0, 0, 255])));
    }

    #[test]
    fn the_rate_is_that_of_the_animation_or_the_usual_one() {
        let rate = |pictures, seconds| FrameRate { pictures, seconds };
        assert_eq!(FrameRate::of(801, 20.0), rate(40, 1));
        assert_eq!(FrameRate::of(800, 20.0), rate(799, 20));
        assert_eq!(FrameRate::of(300, 6.0), rate(299, 6));
        // 99 steps in 3.303 s, both over 9.
        assert_eq!(FrameRate::of(100, 3.3033), rate(11000, 367));
        let usual = [(0, 1.0), (1, 1.0), (9, 0.0), (9, -1.0), (9, f64::NAN), (9, f64::INFINITY), (9, 1e-9)];
        for (pictures, seconds) in usual {
            assert_eq!(FrameRate::of(pictures, seconds), FrameRate::USUAL, "{pictures} in {seconds}");
        }
        assert_eq!(FrameRate::of(u32::MAX, 0.001), FrameRate::USUAL, "no fraction tells it");
    }
}
