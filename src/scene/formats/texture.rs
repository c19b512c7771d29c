//! Pictures for textures: PNG, JPEG and PPM.

use std::io::Cursor;

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::super::source::Source;
use super::super::{Scene, Texture};
use super::ppm;

/// The greatest width and height a picture may have: a small file may unpack to any size.
const MOST: usize = 16_384;

/// Reads a picture that lies beside a scene's file.
///
/// # Errors
/// In words, for a warning: it is not there, or cannot be decoded.
pub(super) fn read(source: &Source, name: &str) -> Result<Texture, String> {
    // Noted in any case, so that the cache learns when it comes.
    if !source.has(name) {
        return Err(format!("texture {name:?} is not there"));
    }
    let bytes =
        source.neighbour(name).map_err(|error| format!("texture {name:?} cannot be read: {error}"))?;
    decode(name, &bytes)
}

/// Gives a scene a picture that was read, and tells its number there; one that could not be is a warning.
pub(super) fn take(scene: &mut Scene, read: Result<Texture, String>) -> Option<u32> {
    match read {
        Ok(texture) => {
            scene.textures.push(texture);
            Some(scene.textures.len() as u32 - 1)
        }
        Err(warning) => {
            scene.warnings.push(warning);
            None
        }
    }
}

/// Decodes a picture; what is transparent in it is taken as it would be if it were not.
///
/// # Errors
/// In words, for a warning.
pub(super) fn decode(name: &str, bytes: &[u8]) -> Result<Texture, String> {
    let decoded = match bytes {
        [0x89, b'P', b'N', b'G', ..] => decode_png(bytes),
        [0xff, 0xd8, ..] => decode_jpeg(bytes),
        [b'P', b'3' | b'6', ..] => ppm::decode(bytes),
        _ => Err("it is neither PNG nor JPEG nor PPM".to_owned()),
    };
    let (width, height, pixels) =
        decoded.map_err(|error| format!("texture {name:?} cannot be decoded: {error}"))?;
    Ok(Texture { name: name.to_owned(), width: width as u32, height: height as u32, pixels })
}

/// Width, height and pixels.
pub(super) type Decoded = (usize, usize, Vec<[u8; 3]>);

fn decode_png(bytes: &[u8]) -> Result<Decoded, String> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|error| error.to_string())?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    check_size(width, height)?;
    let size = reader.output_buffer_size().ok_or("it is too large")?;
    let mut buffer = vec![0; size];
    let frame = reader.next_frame(&mut buffer).map_err(|error| error.to_string())?;
    let channels = frame.color_type.samples();
    Ok((width, height, colours(&buffer[..frame.buffer_size()], channels)))
}

fn decode_jpeg(bytes: &[u8]) -> Result<Decoded, String> {
    let options = DecoderOptions::default()
        .jpeg_set_out_colorspace(ColorSpace::RGB)
        .set_max_width(MOST)
        .set_max_height(MOST);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    let pixels = decoder.decode().map_err(|error| error.to_string())?;
    let (width, height) = decoder.dimensions().ok_or("it has no size")?;
    check_size(width, height)?;
    Ok((width, height, colours(&pixels, 3)))
}

pub(super) fn check_size(width: usize, height: usize) -> Result<(), String> {
    let fits = (1..=MOST).contains(&width) && (1..=MOST).contains(&height);
    if fits { Ok(()) } else { Err(format!("{width} x {height} pixels; expected 1 to {MOST} each way")) }
}

/// Red, green and blue of samples: grey ones have one, and a last one more may be how opaque they are.
fn colours(samples: &[u8], channels: usize) -> Vec<[u8; 3]> {
    let colour = |pixel: &[u8]| if channels < 3 { [pixel[0]; 3] } else { [pixel[0], pixel[1], pixel[2]] };
    samples.chunks_exact(channels).map(colour).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png_of(color: png::ColorType, depth: png::BitDepth, samples: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == png::ColorType::Indexed {
            encoder.set_palette(&[9, 8, 7, 6, 5, 4][..]);
        }
        encoder.write_header().unwrap().write_image_data(samples).unwrap();
        bytes
    }

    #[test]
    fn every_kind_of_png_gives_its_colours() {
        use png::{BitDepth, ColorType};
        for (color, depth, samples, expected) in [
            (ColorType::Rgb, BitDepth::Eight, &[1, 2, 3, 4, 5, 6][..], [[1, 2, 3], [4, 5, 6]]),
            (ColorType::Rgba, BitDepth::Eight, &[1, 2, 3, 0, 4, 5, 6, 9], [[1, 2, 3], [4, 5, 6]]),
            (ColorType::Grayscale, BitDepth::Eight, &[7, 200], [[7; 3], [200; 3]]),
            (ColorType::GrayscaleAlpha, BitDepth::Eight, &[7, 1, 200, 2], [[7; 3], [200; 3]]),
            (ColorType::Grayscale, BitDepth::Sixteen, &[7, 0, 200, 0], [[7; 3], [200; 3]]),
            (ColorType::Indexed, BitDepth::One, &[0b0100_0000], [[9, 8, 7], [6, 5, 4]]),
        ] {
            let texture = decode("t.png", &png_of(color, depth, samples)).unwrap();
            assert_eq!(
                (texture.width, texture.height, texture.pixels),
                (2, 1, expected.to_vec()),
                "{color:?}"
            );
        }
    }

    #[test]
    fn cut_and_garbled_pictures_are_refused_or_read_and_never_panic() {
        let good = png_of(png::ColorType::Rgb, png::BitDepth::Eight, &[1, 2, 3, 4, 5, 6]);
        for end in 0..good.len() - 12 {
            let error = decode("t.png", &good[..end]).unwrap_err();
            assert!(error.starts_with("texture \"t.png\" cannot be decoded: "), "{error}");
        }
        for at in 0..good.len() {
            let mut bytes = good.clone();
            bytes[at] ^= 0x5a;
            let _ = decode("t.png", &bytes);
        }
        assert!(decode("t.jpg", &[0xff, 0xd8, 0xff, 0xe0, 0, 16]).is_err());
        assert!(decode("t.tga", b"anything").unwrap_err().ends_with("neither PNG nor JPEG nor PPM"));
    }
}
