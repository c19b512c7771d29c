//! The words of an AFF file: what stands between blanks, braces and comments. Numbers are read in one pass, each
//! rounded to the nearest as the standard library would.

/// What is wrong, and where: boxed, so that what is right costs little to return.
#[derive(Debug)]
pub(super) struct Fault(pub(super) Box<What>);

/// What is wrong.
#[derive(Debug)]
pub(super) struct What {
    /// Byte of the file.
    pub(super) at: usize,
    pub(super) found: String,
    pub(super) expected: String,
}

impl Fault {
    pub(super) fn new(at: usize, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self(Box::new(What { at, found: found.into(), expected: expected.into() }))
    }
}

/// A text, and how far it has been read.
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    /// The next byte.
    at: usize,
    /// Where the last word began.
    pub(super) start: usize,
    /// A byte, the lines before it and where its own begins, to count on from.
    counted: (usize, u32, usize),
}

/// What a number is made of: `mantissa * 10^exponent`.
struct Decimal {
    mantissa: u64,
    exponent: i32,
    is_negative: bool,
}

/// Digits that any `u64` can hold.
const MOST_DIGITS: u32 = 19;
/// Powers of ten that are exact in f64.
const TENS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

impl<'a> Words<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { bytes, at, start: at, counted: (0, 0, 0) }
    }

    /// Bytes not read yet.
    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Line and column of a byte, from 1. Asked for in the order of the file, all together cost one pass.
    pub(super) fn place(&mut self, at: usize) -> (u32, u32) {
        let (from, mut lines, mut begin) = if at >= self.counted.0 { self.counted } else { (0, 0, 0) };
        for (byte, _) in self.bytes[from..at].iter().enumerate().filter(|(_, byte)| **byte == b'\n') {
            (lines, begin) = (lines + 1, from + byte + 1);
        }
        self.counted = (at, lines, begin);
        (lines + 1, (at - begin) as u32 + 1)
    }

    /// Passes over blanks and comments; the byte after them, if there is one.
    #[inline]
    fn begin(&mut self) -> Option<u8> {
        loop {
            match self.bytes.get(self.at) {
                Some(b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c) => self.at += 1,
                Some(b'#' | b'%') => {
                    let rest = &self.bytes[self.at..];
                    self.at += rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
                }
                other => {
                    self.start = self.at;
                    return other.copied();
                }
            }
        }
    }

    /// The next word; none at the end. A brace is a word of its own.
    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        let first = self.begin()?;
        let rest = &self.bytes[self.at..];
        let ends = |byte: &u8| is_blank(*byte) || matches!(byte, b'{' | b'}');
        let length = match first {
            b'{' | b'}' => 1,
            _ => rest.iter().position(ends).unwrap_or(rest.len()),
        };
        self.at += length;
        Some(&rest[..length])
    }

    /// The next word, without going on.
    pub(super) fn peek(&mut self) -> Option<&'a [u8]> {
        self.begin();
        let before = self.at;
        let word = self.next();
        self.at = before;
        word
    }

    /// Whether a number comes next.
    pub(super) fn is_number_next(&mut self) -> bool {
        self.begin().is_some_and(|byte| byte.is_ascii_digit() || matches!(byte, b'-' | b'+' | b'.'))
    }

    /// The fault that the last word is not what it should be.
    pub(super) fn wrong(&self, expected: impl Into<String>) -> Fault {
        let rest = &self.bytes[self.start..];
        let length = match rest.first() {
            None => return Fault::new(self.start, "the file ends", expected),
            Some(b'{' | b'}') => 1,
            Some(_) => rest.iter().position(|byte| ends_number(*byte)).unwrap_or(rest.len()).max(1),
        };
        let shown = String::from_utf8_lossy(&rest[..length.min(40)]);
        Fault::new(self.start, format!("{shown:?}"), expected)
    }

    /// A word that must be this one.
    pub(super) fn expect(&mut self, word: &str) -> Result<(), Fault> {
        match self.next() {
            Some(found) if found == word.as_bytes() => Ok(()),
            _ => Err(self.wrong(format!("`{word}`"))),
        }
    }

    /// The name of something.
    pub(super) fn name(&mut self, what: &str) -> Result<&'a str, Fault> {
        let word = self.next().filter(|word| !matches!(word, [b'{' | b'}']));
        let word = word.ok_or_else(|| self.wrong(what))?;
        std::str::from_utf8(word).map_err(|_| self.wrong(format!("{what}, in UTF-8")))
    }

    /// A count or an index.
    #[inline]
    pub(super) fn whole(&mut self) -> Result<u32, Fault> {
        self.begin();
        let mut sum = Some(0u32);
        let mut end = self.at;
        while let Some(digit) = self.bytes.get(end).map(|byte| byte.wrapping_sub(b'0')).filter(|d| *d < 10) {
            sum = sum.and_then(|sum| sum.checked_mul(10)?.checked_add(digit.into()));
            end += 1;
        }
        match sum.filter(|_| end > self.at && self.ends_at(end)) {
            Some(sum) => {
                self.at = end;
                Ok(sum)
            }
            None => Err(self.wrong("a whole number from 0 to 4294967295")),
        }
    }

    /// How many items follow, each of at least so many bytes: of room no more is made at once than they can need.
    pub(super) fn count(&mut self, bytes: usize) -> Result<(u32, usize), Fault> {
        let count = self.whole()?;
        Ok((count, (count as usize).min(self.left() / bytes + 1)))
    }

    /// A finite number, rounded to f32.
    #[inline]
    pub(super) fn number(&mut self) -> Result<f32, Fault> {
        let (decimal, end) = self.decimal()?;
        let number = decimal.and_then(|decimal| decimal.to_f32());
        let number = number.or_else(|| self.slowly(end)).filter(|number| number.is_finite());
        self.at = end;
        number.ok_or_else(|| self.wrong("a number within the range of f32"))
    }

    /// A finite number.
    pub(super) fn double(&mut self) -> Result<f64, Fault> {
        let (decimal, end) = self.decimal()?;
        let number = decimal.and_then(|decimal| decimal.to_f64());
        let number = number.or_else(|| self.slowly(end)).filter(|number: &f64| number.is_finite());
        self.at = end;
        number.ok_or_else(|| self.wrong("a number within the range of f64"))
    }

    /// Three numbers.
    #[inline]
    pub(super) fn vector(&mut self) -> Result<glam::Vec3, Fault> {
        Ok(glam::Vec3::new(self.number()?, self.number()?, self.number()?))
    }

    /// Three numbers, exactly.
    pub(super) fn doubles(&mut self) -> Result<glam::DVec3, Fault> {
        Ok(glam::DVec3::new(self.double()?, self.double()?, self.double()?))
    }

    fn ends_at(&self, at: usize) -> bool {
        self.bytes.get(at).is_none_or(|byte| ends_number(*byte))
    }

    /// The number that comes next and where it ends; no decimal if it has too many digits.
    #[inline]
    fn decimal(&mut self) -> Result<(Option<Decimal>, usize), Fault> {
        let first = self.begin();
        let is_negative = first == Some(b'-');
        let mut at = self.at + usize::from(matches!(first, Some(b'-' | b'+')));
        let digit = |at: usize| self.bytes.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|d| *d < 10);
        let (mut mantissa, mut exponent, mut digits, mut seen) = (0u64, 0i32, 0u32, false);
        while let Some(value) = digit(at) {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(value.into());
            // Those in front of the first that is not 0 do not count.
            digits += u32::from(mantissa != 0 || digits > 0);
            (at, seen) = (at + 1, true);
        }
        if self.bytes.get(at) == Some(&b'.') {
            at += 1;
            let begin = at;
            while let Some(value) = digit(at) {
                mantissa = mantissa.wrapping_mul(10).wrapping_add(value.into());
                digits += u32::from(mantissa != 0 || digits > 0);
                (at, seen) = (at + 1, true);
            }
            exponent = -i32::try_from(at - begin).unwrap_or(i32::MAX);
        }
        if seen && matches!(self.bytes.get(at), Some(b'e' | b'E')) {
            let sign = self.bytes.get(at + 1).filter(|byte| matches!(byte, b'-' | b'+'));
            let begin = at + 1 + usize::from(sign.is_some());
            let mut power = 0i32;
            at = begin;
            while let Some(value) = digit(at) {
                power = power.saturating_mul(10).saturating_add(value.into());
                at += 1;
            }
            seen = at > begin;
            exponent = exponent.saturating_add(if sign == Some(&b'-') { -power } else { power });
        }
        if !seen || !self.ends_at(at) {
            return Err(self.wrong("a number"));
        }
        let decimal = Decimal { mantissa, exponent, is_negative };
        Ok(((digits <= MOST_DIGITS).then_some(decimal), at))
    }

    /// What the standard library makes of the last word.
    #[cold]
    fn slowly<T: std::str::FromStr>(&self, end: usize) -> Option<T> {
        std::str::from_utf8(&self.bytes[self.start..end]).ok()?.parse().ok()
    }
}

impl Decimal {
    /// Exact if both numbers are, as one division or multiplication rounds once (Clinger 1990).
    fn to_f64(&self) -> Option<f64> {
        let ten = TENS.get(self.exponent.unsigned_abs() as usize)?;
        if self.mantissa > 1 << f64::MANTISSA_DIGITS {
            return None;
        }
        let number = self.mantissa as f64;
        let number = if self.exponent < 0 { number / ten } else { number * ten };
        Some(if self.is_negative { -number } else { number })
    }

    /// Rounded twice, which differs from once only where the first time ends on the middle between two f32.
    fn to_f32(&self) -> Option<f32> {
        let number = self.to_f64()?;
        let below = f64::MANTISSA_DIGITS - f32::MANTISSA_DIGITS;
        let is_middle = number.to_bits() & ((1 << below) - 1) == 1 << (below - 1);
        let is_normal = number == 0.0 || number.abs() >= f64::from(f32::MIN_POSITIVE);
        (is_normal && !is_middle).then_some(number as f32)
    }
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c)
}

fn ends_number(byte: u8) -> bool {
    is_blank(byte) || matches!(byte, b'{' | b'}' | b'#' | b'%')
}

#[cfg(test)]
#[path = "words_tests.rs"]
mod tests;
