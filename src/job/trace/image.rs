//! Pictures as files.

use std::io::{self, Write};

/// A picture in linear colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Red, green and blue, 1 being white, row by row from the top.
    pub pixels: Vec<[f32; 3]>,
}

impl Image {
    /// Red, green and blue of each pixel in 8 bits, coded as sRGB: below 0 and NaN are black, beyond 1 is white.
    pub fn codes(&self) -> Vec<u8> {
        self.pixels.as_flattened().iter().map(|linear| coded(*linear)).collect()
    }

    /// Writes it as PNG, 8 bits a colour, coded as sRGB: below 0 and NaN are black, beyond 1 is white.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write_png(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut encoder = png::Encoder::new(out, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.codes())?;
        Ok(writer.finish()?)
    }

    /// Writes it as a Portable Float Map: linear colours as they are, the lowest row first, least significant byte
    /// first.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write_pfm(&self, out: &mut dyn Write) -> io::Result<()> {
        write!(out, "PF\n{} {}\n-1.0\n", self.width, self.height)?;
        for row in self.pixels.chunks_exact(self.width as usize).rev() {
            let bytes: Vec<u8> = row.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
            out.write_all(&bytes)?;
        }
        Ok(())
    }

    /// Writes it as OpenEXR ("OpenEXR File Layout", version 2): one part of scan lines, 32-bit floats, not packed;
    /// linear colours as they are.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write_exr(&self, out: &mut dyn Write) -> io::Result<()> {
        let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
        let mut head = words(&[20_000_630, 2]);
        let mut attribute = |name: &str, kind: &str, value: &[u8]| {
            head.extend(name.bytes().chain([0]).chain(kind.bytes()).chain([0]));
            head.extend((value.len() as u32).to_le_bytes());
            head.extend(value);
        };
        // In the order of the alphabet; each of floats (2), not to be coded otherwise, each pixel of it there.
        let mut channels: Vec<u8> = Vec::new();
        for name in [b'B', b'G', b'R'] {
            channels.extend([name, 0]);
            channels.extend(words(&[2, 0, 1, 1]));
        }
        channels.push(0);
        let window = words(&[0, 0, self.width - 1, self.height - 1]);
        let one = 1.0_f32.to_le_bytes();
        attribute("channels", "chlist", &channels);
        attribute("compression", "compression", &[0]);
        attribute("dataWindow", "box2i", &window);
        attribute("displayWindow", "box2i", &window);
        attribute("lineOrder", "lineOrder", &[0]);
        attribute("pixelAspectRatio", "float", &one);
        attribute("screenWindowCenter", "v2f", &[0; 8]);
        attribute("screenWindowWidth", "float", &one);
        head.push(0);
        out.write_all(&head)?;
        // Where each row is: its number, its length, then blue, green and red of all its pixels.
        let row = 12 * u64::from(self.width);
        let first = head.len() as u64 + 8 * u64::from(self.height);
        for y in 0..u64::from(self.height) {
            out.write_all(&(first + y * (row + 8)).to_le_bytes())?;
        }
        for (y, pixels) in (0..).zip(self.pixels.chunks_exact(self.width as usize)) {
            out.write_all(&words(&[y, row as u32]))?;
            let parts = [2, 1, 0].into_iter().flat_map(|part| pixels.iter().map(move |pixel| pixel[part]));
            out.write_all(&parts.flat_map(f32::to_le_bytes).collect::<Vec<u8>>())?;
        }
        Ok(())
    }
}

/// The sRGB code of a linear colour (IEC 61966-2-1).
fn coded(linear: f32) -> u8 {
    let linear = f64::from(linear);
    let coded = if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    // A cast takes NaN to 0 and stays within the type.
    (coded * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    fn image() -> Image {
        let pixels =
            (0..15).map(|i| [i as f32 * 0.07, 1.0 - i as f32 * 0.07, (i % 4) as f32 * 0.5]).collect();
        Image { width: 5, height: 3, pixels }
    }

    #[test]
    fn png_comes_back_as_srgb_codes() {
        let mut bytes = Vec::new();
        let mut picture = image();
        picture.pixels[0] = [f32::NAN, -1.0, 7.0];
        picture.pixels[1] = [0.5, 0.002, 1.0];
        picture.write_png(&mut bytes).unwrap();
        let mut reader = png::Decoder::new(Cursor::new(&bytes)).read_info().unwrap();
        let mut codes = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut codes).unwrap();
        assert_eq!((frame.width, frame.height, frame.color_type), (5, 3, png::ColorType::Rgb));
        assert!(reader.info().srgb.is_some());
        // Half of white is code 188, and 0.002 lies on the straight piece.
        assert_eq!(codes[..6], [0, 0, 255, 188, 7, 255]);
        let brighter = codes.chunks(3).skip(2).map(|code| code[0]);
        assert!(brighter.is_sorted());
    }

    #[test]
    fn pfm_holds_the_rows_from_below() {
        let (mut bytes, picture) = (Vec::new(), image());
        picture.write_pfm(&mut bytes).unwrap();
        let body = bytes.strip_prefix(b"PF\n5 3\n-1.0\n").unwrap();
        let numbers: Vec<f32> = body.as_chunks().0.iter().map(|number| f32::from_le_bytes(*number)).collect();
        let expected: Vec<f32> = [2, 1, 0]
            .into_iter()
            .flat_map(|row| picture.pixels[row * 5..][..5].as_flattened().to_vec())
            .collect();
        assert_eq!(numbers, expected);
    }

    #[test]
    fn exr_rows_lie_where_its_table_says() {
        let (mut bytes, picture) = (Vec::new(), image());
        picture.write_exr(&mut bytes).unwrap();
        assert!(bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]));
        // The rows are the last of it, the table stands before them.
        let row = 8 + 12 * 5;
        let table = bytes.len() - 3 * row - 3 * 8;
        assert_eq!(bytes[table - 1], 0, "the header ends");
        for y in 0..3 {
            let entry: [u8; 8] = bytes[table + 8 * y..][..8].try_into().unwrap();
            let at = u64::from_le_bytes(entry) as usize;
            assert_eq!(at, table + 24 + y * row);
            assert_eq!(bytes[at..at + 8], [y as u8, 0, 0, 0, 60, 0, 0, 0]);
            for (channel, part) in [2, 1, 0].into_iter().enumerate() {
                for x in 0..5 {
                    let number: [u8; 4] = bytes[at + 8 + 4 * (channel * 5 + x)..][..4].try_into().unwrap();
                    assert_eq!(f32::from_le_bytes(number), picture.pixels[y * 5 + x][part]);
                }
            }
        }
    }
}
