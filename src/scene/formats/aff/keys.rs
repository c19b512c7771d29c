//! `k`: key frames of a transform.

use glam::Quat;

use super::super::super::{Curve, Motion, SplineKey};
use super::parse::rotation;
use super::words::{Fault, Words};

/// The first and the last key only shape the curve: fewer leave no curve.
const LEAST_KEYS: u32 = 4;
/// The least a key takes: a time, a value, a blank after each.
const KEY: usize = 4;

/// Reads a name and the lists of keys in its braces. Keys that are earlier than one before them can be reached at no
/// time, as one of BART's own files has them: they are left out, with a warning.
pub(super) fn read(words: &mut Words<'_>, warnings: &mut Vec<String>) -> Result<Motion, Fault> {
    let mut motion = Motion { name: words.name("the name of what moves")?.to_owned(), ..Motion::default() };
    words.expect("{")?;
    let (mut is_visibility_told, mut late) = (false, 0);
    loop {
        let twice = |words: &Words<'_>| Err(words.wrong("each kind of keys once"));
        match words.next() {
            Some(b"transl") if motion.translation.is_some() => return twice(words),
            Some(b"scale") if motion.scale.is_some() => return twice(words),
            Some(b"rot") if motion.rotation.is_some() => return twice(words),
            Some(b"visibility") if is_visibility_told => return twice(words),
            Some(b"transl") => motion.translation = Some(spline(words, Words::vector, &mut late)?),
            Some(b"scale") => motion.scale = Some(spline(words, Words::vector, &mut late)?),
            Some(b"rot") => motion.rotation = Some(spline(words, turn, &mut late)?),
            Some(b"visibility") => {
                motion.visibility = visibility(words)?;
                is_visibility_told = true;
            }
            Some(b"}") => break,
            _ => return Err(words.wrong("`transl`, `scale`, `rot`, `visibility` or `}`")),
        }
    }
    if late > 0 {
        warnings.push(format!("{late} keys of {:?} are earlier than one before them: left out", motion.name));
    }
    Ok(motion)
}

/// Rounded as it is, so that more than half a turn stays more.
fn turn(words: &mut Words<'_>) -> Result<Quat, Fault> {
    rotation(words).map(|turn| turn.as_quat())
}

fn spline<'a, T>(
    words: &mut Words<'a>,
    value: impl Fn(&mut Words<'a>) -> Result<T, Fault>,
    late: &mut usize,
) -> Result<Curve<T>, Fault> {
    let (count, room) = words.count(KEY)?;
    if count < LEAST_KEYS {
        return Err(words.wrong(format!("at least {LEAST_KEYS} keys")));
    }
    let mut keys: Vec<SplineKey<T>> = Vec::with_capacity(room);
    for _ in 0..count {
        let key = SplineKey {
            time: words.double()?,
            value: value(words)?,
            tension: words.number()?,
            continuity: words.number()?,
            bias: words.number()?,
        };
        match keys.last().is_some_and(|last| key.time < last.time) {
            true => *late += 1,
            false => keys.push(key),
        }
    }
    match keys.len() < LEAST_KEYS as usize {
        true => Err(words.wrong(format!("at least {LEAST_KEYS} keys in the order of their times before it"))),
        false => Ok(Curve::Spline(keys)),
    }
}

fn visibility(words: &mut Words<'_>) -> Result<Vec<(f64, bool)>, Fault> {
    let (count, room) = words.count(KEY)?;
    if count == 0 {
        return Err(words.wrong("at least 1 key"));
    }
    let mut keys: Vec<(f64, bool)> = Vec::with_capacity(room);
    for _ in 0..count {
        let time = time(words, keys.last().map(|key| key.0))?;
        let is_seen = match words.whole()? {
            0 => false,
            1 => true,
            _ => return Err(words.wrong("0 or 1")),
        };
        keys.push((time, is_seen));
    }
    Ok(keys)
}

/// A key's time, in seconds: not before the last one's.
pub(super) fn time(words: &mut Words<'_>, last: Option<f64>) -> Result<f64, Fault> {
    let time = words.double()?;
    match last.filter(|last| time < *last) {
        Some(last) => Err(words.wrong(format!("a time not before {last}"))),
        None => Ok(time),
    }
}
