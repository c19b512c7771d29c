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
        let codes: Vec<u8> = self.pixels.as_flattened().iter().map(|linear| coded(*linear)).collect();
        writer.write_image_data(&codes)?;
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
}

/// The sRGB code of a linear colour (IEC 61966-2-1).
fn coded(linear: f32) -> u8 {
    let linear = f64::from(linear);
    let coded = if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    // A cast takes NaN to 0 and stays within the type.
    (coded * 255.0).round() as u8
}
