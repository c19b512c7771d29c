//! The layout of what moves in a kept scene.

use glam::{Quat, Vec3};

use super::layout::{Reader, put, put_count};
use crate::scene::{Animation, Bend, BendKey, Curve, HermiteKey, Motion, SplineKey};

/// Stands for no motion.
const NONE: u32 = u32::MAX;

/// What a curve leads through, as so many 32-bit floats.
trait Value: Copy {
    fn put(self, out: &mut Vec<u8>);
    fn read(from: &mut Reader<'_>) -> Option<Self>;
}

impl Value for Vec3 {
    fn put(self, out: &mut Vec<u8>) {
        put_floats(out, &self.to_array());
    }

    fn read(from: &mut Reader<'_>) -> Option<Self> {
        from.vector()
    }
}

impl Value for Quat {
    fn put(self, out: &mut Vec<u8>) {
        put_floats(out, &self.to_array());
    }

    fn read(from: &mut Reader<'_>) -> Option<Self> {
        Some(Self::from_xyzw(from.number()?, from.number()?, from.number()?, from.number()?))
    }
}

fn put_floats(out: &mut Vec<u8>, numbers: &[f32]) {
    out.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
}

fn put_time(out: &mut Vec<u8>, time: f64) {
    out.extend(time.to_le_bytes());
}

fn put_list<T>(out: &mut Vec<u8>, list: &[T], item: impl Fn(&mut Vec<u8>, &T)) -> Option<()> {
    put_count(out, list.len())?;
    list.iter().for_each(|entry| item(out, entry));
    Some(())
}

/// What moves; `None` if a list is too long for its length.
pub(super) fn put_animation(out: &mut Vec<u8>, animation: &Animation) -> Option<()> {
    put_time(out, animation.start);
    put_time(out, animation.end);
    out.extend(animation.frames.to_le_bytes());
    put_count(out, animation.motions.len())?;
    for motion in &animation.motions {
        put(out, motion.name.bytes())?;
        put_curve(out, motion.translation.as_ref())?;
        put_curve(out, motion.rotation.as_ref())?;
        put_curve(out, motion.scale.as_ref())?;
        put_list(out, &motion.visibility, |out, (time, seen)| {
            put_time(out, *time);
            out.push(u8::from(*seen));
        })?;
    }
    let put_pair = |out: &mut Vec<u8>, (item, motion): &(u32, u32)| {
        out.extend(item.to_le_bytes());
        out.extend(motion.to_le_bytes());
    };
    put_list(out, &animation.followers, put_pair)?;
    out.extend(animation.camera.unwrap_or(NONE).to_le_bytes());
    put_list(out, &animation.lights, put_pair)?;
    put_count(out, animation.bends.len())?;
    for bend in &animation.bends {
        out.extend(bend.mesh.to_le_bytes());
        put_count(out, bend.keys.len())?;
        for key in &bend.keys {
            put_time(out, key.time);
            put_list(out, &key.positions, |out, position| position.put(out))?;
            put_list(out, &key.normals, |out, normal| normal.put(out))?;
        }
    }
    Some(())
}

/// The kind of a curve in a byte, 0 where there is none, and its keys.
fn put_curve<T: Value>(out: &mut Vec<u8>, curve: Option<&Curve<T>>) -> Option<()> {
    let put_key = |out: &mut Vec<u8>, (time, value): &(f64, T)| {
        put_time(out, *time);
        value.put(out);
    };
    match curve {
        None => out.push(0),
        Some(Curve::Spline(keys)) => {
            out.push(1);
            put_list(out, keys, |out, key| {
                put_time(out, key.time);
                key.value.put(out);
                put_floats(out, &[key.tension, key.continuity, key.bias]);
            })?;
        }
        Some(Curve::Linear(keys)) => {
            out.push(2);
            put_list(out, keys, put_key)?;
        }
        Some(Curve::Steps(keys)) => {
            out.push(3);
            put_list(out, keys, put_key)?;
        }
        Some(Curve::Hermite(keys)) => {
            out.push(4);
            put_list(out, keys, |out, key| {
                put_time(out, key.time);
                [key.value, key.arriving, key.leaving].into_iter().for_each(|value| value.put(out));
            })?;
        }
    }
    Some(())
}

/// Reads what [`put_animation`] wrote.
pub(super) fn read_animation(from: &mut Reader<'_>) -> Option<Animation> {
    let pair = |from: &mut Reader<'_>| Some((from.word()?, from.word()?));
    Some(Animation {
        start: from.time()?,
        end: from.time()?,
        frames: from.word()?,
        motions: from.list(read_motion)?,
        followers: from.list(pair)?,
        camera: Some(from.word()?).filter(|motion| *motion != NONE),
        lights: from.list(pair)?,
        bends: from.list(|from| Some(Bend { mesh: from.word()?, keys: from.list(read_bend_key)? }))?,
    })
}

fn read_motion(from: &mut Reader<'_>) -> Option<Motion> {
    Some(Motion {
        name: from.text()?,
        translation: read_curve(from)?,
        rotation: read_curve(from)?,
        scale: read_curve(from)?,
        visibility: from.list(|from| {
            let (time, [seen]) = (from.time()?, from.array()?);
            Some((time, seen != 0))
        })?,
    })
}

/// None twice: nothing that can be read, or no curve.
fn read_curve<T: Value>(from: &mut Reader<'_>) -> Option<Option<Curve<T>>> {
    let key = |from: &mut Reader<'_>| Some((from.time()?, T::read(from)?));
    let [kind] = from.array()?;
    Some(Some(match kind {
        0 => return Some(None),
        1 => Curve::Spline(from.list(|from| {
            let (time, value) = key(from)?;
            let (tension, continuity, bias) = (from.number()?, from.number()?, from.number()?);
            Some(SplineKey { time, value, tension, continuity, bias })
        })?),
        2 => Curve::Linear(from.list(key)?),
        3 => Curve::Steps(from.list(key)?),
        4 => Curve::Hermite(from.list(|from| {
            let (time, value) = key(from)?;
            Some(HermiteKey { time, value, arriving: T::read(from)?, leaving: T::read(from)? })
        })?),
        _ => return None,
    }))
}

fn read_bend_key(from: &mut Reader<'_>) -> Option<BendKey> {
    let (time, vector) = (from.time()?, |from: &mut Reader<'_>| from.vector());
    Some(BendKey { time, positions: from.list(vector)?, normals: from.list(vector)? })
}
