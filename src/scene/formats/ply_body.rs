//! The numbers of a PLY file, one after the other, from text or binary. Nothing is believed that the
//! header or a list says about how much there is to come.

use super::ply_header::{Encoding, Fault, Kind};

/// What follows the header.
pub(super) trait Body {
    /// The next number, whatever it is, rounded to f32.
    fn number(&mut self, kind: Kind) -> Result<f32, Fault>;
    /// The next number as a coordinate: finite, rounded to f32.
    #[inline]
    fn coordinate(&mut self, kind: Kind) -> Result<f32, Fault> {
        let number = self.number(kind)?;
        if number.is_finite() { Ok(number) } else { Err((number.to_string(), FINITE.to_string())) }
    }
    /// The next number as a count or an index.
    fn whole(&mut self, kind: Kind) -> Result<u32, Fault>;
    /// Passes over numbers.
    fn skip(&mut self, kind: Kind, count: usize) -> Result<(), Fault>;
    /// Goes to the beginning of the next item.
    fn next_item(&mut self) -> Result<(), Fault>;
    /// Checks that nothing follows the last item.
    fn finish(&mut self) -> Result<(), Fault>;
    /// Bytes not read yet.
    fn left(&self) -> usize;
    /// Where it is, for messages.
    fn place(&self) -> String;
}

/// Numbers as text: each item on a line of its own.
pub(super) struct Text<'a> {
    rest: &'a [u8],
    /// What is left of the line.
    line: &'a [u8],
    number: usize,
}

impl<'a> Text<'a> {
    /// The body after a header of so many lines.
    pub(super) fn new(rest: &'a [u8], lines: usize) -> Self {
        Self { rest, line: &[], number: lines }
    }

    fn word(&mut self) -> Option<&'a [u8]> {
        let line = self.line.trim_ascii_start();
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (word, rest) = line.split_at(end);
        self.line = rest;
        (!word.is_empty()).then_some(word)
    }

    fn needed(&mut self, expected: &str) -> Result<&'a [u8], Fault> {
        self.word().ok_or_else(|| ("the line ends".to_string(), expected.to_string()))
    }
}

impl Body for Text<'_> {
    fn number(&mut self, _: Kind) -> Result<f32, Fault> {
        let word = self.needed("a number")?;
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or_else(|| (shown(word), FINITE.to_string()))
    }

    fn coordinate(&mut self, _: Kind) -> Result<f32, Fault> {
        let word = self.needed("a coordinate")?;
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.filter(|number: &f32| number.is_finite()).ok_or_else(|| (shown(word), FINITE.to_string()))
    }

    fn whole(&mut self, _: Kind) -> Result<u32, Fault> {
        let word = self.needed("a count or an index")?;
        let digit = |sum: u32, digit: &u8| {
            let value = digit.checked_sub(b'0').filter(|value| *value <= 9)?;
            sum.checked_mul(10)?.checked_add(value.into())
        };
        word.iter().try_fold(0, digit).ok_or_else(|| (shown(word), WHOLE.to_string()))
    }

    fn skip(&mut self, _: Kind, count: usize) -> Result<(), Fault> {
        (0..count).try_for_each(|_| self.needed("one more number").map(|_| ()))
    }

    fn next_item(&mut self) -> Result<(), Fault> {
        if let Some(word) = self.word() {
            return Err((format!("{} more", shown(word)), "the end of the line".to_string()));
        }
        // Blank lines are no items.
        while self.line.trim_ascii().is_empty() {
            if self.rest.is_empty() {
                return Err(("the file ends".to_string(), "more lines".to_string()));
            }
            let end = self.rest.iter().position(|byte| *byte == b'\n').unwrap_or(self.rest.len());
            self.line = &self.rest[..end];
            self.rest = self.rest.get(end + 1..).unwrap_or_default();
            self.number += 1;
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<(), Fault> {
        match self.next_item() {
            Ok(()) => Err(("a line more than the header counts".to_string(), END.to_string())),
            Err(_) if self.rest.is_empty() && self.line.trim_ascii().is_empty() => Ok(()),
            Err(fault) => Err(fault),
        }
    }

    fn left(&self) -> usize {
        // The last line may end without a line feed.
        self.rest.len() + 1
    }

    fn place(&self) -> String {
        format!("line {}", self.number)
    }
}

/// Numbers as bytes, the most significant first or last.
pub(super) struct Binary<'a> {
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
}

impl<'a> Binary<'a> {
    /// The body that begins at a byte of a file.
    pub(super) fn new(bytes: &'a [u8], at: usize, encoding: Encoding) -> Self {
        Self { bytes, at, encoding }
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        let end = self.at.checked_add(count);
        let taken = end.and_then(|end| self.bytes.get(self.at..end)).ok_or_else(|| {
            (format!("the file ends {} bytes on", self.bytes.len() - self.at), format!("{count} bytes"))
        })?;
        self.at += count;
        Ok(taken)
    }

    #[inline]
    fn array<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.take(N)?);
        if self.encoding == Encoding::Big {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

impl Body for Binary<'_> {
    #[inline]
    fn number(&mut self, kind: Kind) -> Result<f32, Fault> {
        Ok(match kind {
            Kind::I8 => i8::from_le_bytes(self.array()?).into(),
            Kind::U8 => u8::from_le_bytes(self.array()?).into(),
            Kind::I16 => i16::from_le_bytes(self.array()?).into(),
            Kind::U16 => u16::from_le_bytes(self.array()?).into(),
            Kind::I32 => i32::from_le_bytes(self.array()?) as f32,
            Kind::U32 => u32::from_le_bytes(self.array()?) as f32,
            Kind::F32 => f32::from_le_bytes(self.array()?),
            Kind::F64 => f64::from_le_bytes(self.array()?) as f32,
        })
    }

    #[inline]
    fn whole(&mut self, kind: Kind) -> Result<u32, Fault> {
        let number: i64 = match kind {
            Kind::I8 => i8::from_le_bytes(self.array()?).into(),
            Kind::U8 => u8::from_le_bytes(self.array()?).into(),
            Kind::I16 => i16::from_le_bytes(self.array()?).into(),
            Kind::U16 => u16::from_le_bytes(self.array()?).into(),
            Kind::I32 => i32::from_le_bytes(self.array()?).into(),
            Kind::U32 => u32::from_le_bytes(self.array()?).into(),
            Kind::F32 | Kind::F64 => return Err((format!("{kind:?}"), WHOLE.to_string())),
        };
        u32::try_from(number).map_err(|_| (number.to_string(), WHOLE.to_string()))
    }

    fn skip(&mut self, kind: Kind, count: usize) -> Result<(), Fault> {
        self.take(kind.size().saturating_mul(count)).map(|_| ())
    }

    fn next_item(&mut self) -> Result<(), Fault> {
        Ok(())
    }

    fn finish(&mut self) -> Result<(), Fault> {
        match self.left() {
            0 => Ok(()),
            left => Err((format!("{left} bytes more than the header counts"), END.to_string())),
        }
    }

    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn place(&self) -> String {
        format!("byte {}", self.at)
    }
}

const FINITE: &str = "a finite number";
const WHOLE: &str = "a whole number from 0 to 4294967295";
const END: &str = "the end of the file";

/// A word for a message.
fn shown(word: &[u8]) -> String {
    format!("{:?}", String::from_utf8_lossy(&word[..word.len().min(40)]))
}
