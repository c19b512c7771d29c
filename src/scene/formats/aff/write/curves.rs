//! Motions as `k`. Straight lines and steps are splines, too, of the right tension, continuity and bias.

use std::fmt::Write as _;

use glam::{Quat, Vec3};

use super::super::super::super::{Curve, Motion, Scene, SplineKey};
use super::Out;

impl Out {
    /// The key frames of everything that moves.
    pub(super) fn motions(&mut self, scene: &Scene) {
        let mut straightened = 0;
        for (motion, name) in scene.animation.motions.iter().zip(self.names.motions.clone()) {
            let _ = writeln!(self.text, "k {name} {{");
            straightened += self.keys(motion);
            self.text.push_str("}\n");
        }
        if straightened > 0 {
            self.warnings.push(format!(
                "{straightened} curves have slopes of their own: written straight from key to key"
            ));
        }
    }

    /// The keys of a motion, and how many of its curves were straightened.
    fn keys(&mut self, motion: &Motion) -> usize {
        let vector = |out: &mut Self, value: Vec3| out.vector(value);
        let turn = |out: &mut Self, value: Quat| out.turn(value.as_dquat());
        let curves = [
            motion.scale.as_ref().map(|curve| self.curve("scale", curve, vector)),
            motion.rotation.as_ref().map(|curve| self.curve("rot", curve, turn)),
            motion.translation.as_ref().map(|curve| self.curve("transl", curve, vector)),
        ];
        if !motion.visibility.is_empty() {
            let _ = writeln!(self.text, "visibility {}", motion.visibility.len());
            for (time, is_seen) in &motion.visibility {
                let _ = writeln!(self.text, "{time} {}", u8::from(*is_seen));
            }
        }
        curves.iter().filter(|is_straightened| **is_straightened == Some(true)).count()
    }

    /// One curve; whether it had to be straightened.
    fn curve<T: Copy>(&mut self, word: &str, curve: &Curve<T>, value: impl Fn(&mut Self, T)) -> bool {
        let keys = match curve {
            Curve::Spline(keys) => keys.clone(),
            Curve::Linear(keys) => straight(keys),
            Curve::Steps(keys) => straight(&stepped(keys)),
            Curve::Hermite(keys) => {
                straight(&keys.iter().map(|key| (key.time, key.value)).collect::<Vec<_>>())
            }
        };
        let _ = writeln!(self.text, "{word} {}", keys.len());
        for key in &keys {
            let _ = write!(self.text, "{}", key.time);
            value(self, key.value);
            self.numbers(&[key.tension, key.continuity, key.bias]);
            self.text.push('\n');
        }
        matches!(curve, Curve::Hermite(keys) if keys.len() > 1)
    }
}

/// Each value until just before the next.
fn stepped<T: Copy>(keys: &[(f64, T)]) -> Vec<(f64, T)> {
    let held = keys.windows(2).flat_map(|pair| [pair[0], (pair[1].0, pair[0].1)]);
    held.chain(keys.last().copied()).collect()
}

/// Keys of a spline that is straight between these: of continuity -1 the slope before a key depends on the segment
/// before it alone, and the slope after it on the one after. It is that of the straight line if the tension T and the
/// bias B make up for the factors of unequal times, `2 p / (p + n)` of the time `p` before and `2 n / (p + n)` of the
/// time `n` after: `B = (n - p) / (n + p)`, `1 - T = (p + n)^2 / (4 p n)`.
fn straight<T: Copy>(keys: &[(f64, T)]) -> Vec<SplineKey<T>> {
    let (Some(first), Some(last)) = (keys.first(), keys.last()) else { return Vec::new() };
    // The first and the last key of a spline only shape it, and there must be two between them.
    let mut all = vec![(first.0 - 1.0, first.1)];
    all.extend(keys);
    if keys.len() == 1 {
        all.push((last.0 + 1.0, last.1));
    }
    all.push((last.0 + 2.0, last.1));
    let shaped = |at: usize| {
        let (time, value) = all[at];
        let before = if at == 0 { 0.0 } else { time - all[at - 1].0 };
        let after = all.get(at + 1).map_or(0.0, |next| next.0 - time);
        let (tension, bias) = match before > 0.0 && after > 0.0 {
            true => {
                (1.0 - (before + after).powi(2) / (4.0 * before * after), (after - before) / (after + before))
            }
            // On the side that takes no time there is no slope, and the other's factor is 2.
            false => (0.5, 0.0),
        };
        SplineKey { time, value, tension: tension as f32, continuity: -1.0, bias: bias as f32 }
    };
    (0..all.len()).map(shaped).collect()
}
