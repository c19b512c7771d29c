//! PPM (netpbm): pictures as text (`P3`) or bytes (`P6`), up to 65,535 shades a colour.

use std::borrow::Cow;

use super::super::Texture;
use super::texture::{Decoded, check_size};

/// Decodes a picture; of several in one file the first.
///
/// # Errors
/// In words: what is wrong with it.
pub(super) fn decode(bytes: &[u8]) -> Result<Decoded, String> {
    let is_text = bytes.get(1) == Some(&b'3');
    let mut numbers = Numbers { rest: bytes.get(2..).unwrap_or_default() };
    let mut next = || numbers.next().map(|number| number as usize);
    let (width, height, most) = (next()?, next()?, next()?);
    check_size(width, height)?;
    if !(1..=65_535).contains(&most) {
        return Err(format!("{most} shades; expected 1 to 65535"));
    }
    let count = 3 * width * height;
    let shade = |value: usize| ((value.min(most) * 255 + most / 2) / most) as u8;
    let samples: Cow<'_, [u8]> = if is_text {
        // Each takes a digit and a blank, but for the last one's.
        if numbers.rest.len() + 1 < 2 * count {
            return Err(CUT.to_owned());
        }
        let read = (0..count).map(|_| Ok(shade(numbers.next()? as usize)));
        Cow::Owned(read.collect::<Result<_, String>>()?)
    } else {
        // A single blank ends the header.
        let body = numbers.rest.get(1..).unwrap_or_default();
        let each = if most < 256 { 1 } else { 2 };
        let body = body.get(..count * each).ok_or(CUT)?;
        match (each, most) {
            (1, 255) => Cow::Borrowed(body),
            (1, _) => body.iter().map(|value| shade(usize::from(*value))).collect(),
            _ => body.as_chunks().0.iter().map(|value| shade(u16::from_be_bytes(*value).into())).collect(),
        }
    };
    Ok((width, height, samples.as_chunks().0.to_vec()))
}

/// A texture as bytes of a `P6` file.
pub(super) fn encode(texture: &Texture) -> Vec<u8> {
    let header = format!("P6\n{} {}\n255\n", texture.width, texture.height);
    [header.as_bytes(), texture.pixels.as_flattened()].concat()
}

const CUT: &str = "it ends before its last pixel";

/// The numbers of a text.
struct Numbers<'a> {
    rest: &'a [u8],
}

impl Numbers<'_> {
    fn next(&mut self) -> Result<u32, String> {
        loop {
            self.rest = self.rest.trim_ascii_start();
            if self.rest.first() != Some(&b'#') {
                break;
            }
            let end = self.rest.iter().position(|byte| *byte == b'\n').unwrap_or(self.rest.len());
            self.rest = &self.rest[end..];
        }
        let digits = self.rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let (word, rest) = self.rest.split_at(digits);
        self.rest = rest;
        let number = word
            .iter()
            .try_fold(0u32, |sum, digit| sum.checked_mul(10)?.checked_add(u32::from(digit - b'0')));
        number.filter(|_| digits > 0).ok_or_else(|| "a number is missing or too large".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_bytes_of_all_depths_give_the_same() {
        let expected = (2, 1, vec![[0, 128, 255], [255, 0, 128]]);
        for bytes in [
            &b"P3 2 1 255  0 128 255  255 0 128"[..],
            b"P3#c\n2 #c 3 4\n1\n2\n0 1 2 # c\n2 0 1\n",
            b"P6\n# made by hand\n2 1\n255\n\x00\x80\xff\xff\x00\x80",
            b"P6 2 1 255\n\x00\x80\xff\xff\x00\x80P6 1 1 255 abc",
            b"P6 2 1 65535\n\x00\x00\x80\x80\xff\xff\xff\xff\x00\x00\x80\x80",
        ] {
            assert_eq!(decode(bytes).as_ref(), Ok(&expected), "{:?}", String::from_utf8_lossy(bytes));
        }
        let many = decode(b"P6 1 1 15\n\x00\x08\xff").unwrap();
        assert_eq!(many.2, [[0, 136, 255]], "what is too large is the largest");
    }

    #[test]
    fn what_was_encoded_comes_back() {
        let pixels: Vec<[u8; 3]> = (0..35).map(|at| [at, b'#', b'\n']).collect();
        let texture = Texture { name: "t".into(), width: 5, height: 7, pixels };
        assert_eq!(decode(&encode(&texture)), Ok((5, 7, texture.pixels)));
    }

    #[test]
    fn cut_and_absurd_pictures_are_refused() {
        for good in [&b"P3 2 1 255  0 128 255  255 0 12"[..], b"P6 2 1 255\n\x00\x80\xff\xff\x00\x80"] {
            for end in 0..good.len() - 1 {
                assert!(decode(&good[..end]).is_err(), "{end}");
            }
        }
        let huge: [&[u8]; 6] = [
            b"P3 16384 16384 255 1 2 3",
            b"P6 16384 16384 255 abc",
            b"P6 99999999999 1 255 abc",
            b"P6 0 1 255 abc",
            b"P6 1 1 0 abc",
            b"P6 1 1 65536 abc",
        ];
        for bytes in huge {
            assert!(decode(bytes).is_err(), "{:?}", String::from_utf8_lossy(bytes));
        }
    }
}
