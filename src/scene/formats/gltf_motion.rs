//! The animation of a glTF file: nodes that move, turn and are scaled as its channels say (glTF 2.0 sec. 3.11).
//!
//! The first animation is played, from its first key frame to its last; glTF asks for no number of frames, so it is
//! given 30 a second. Other animations are left out, with a warning each, and so is a channel that is not right: the
//! shape is whole without it. What bends, by skins or morph targets, is read in `gltf_bend.rs`.

use std::collections::BTreeMap;

use glam::{Quat, Vec3};
use gltf::animation::{Interpolation, Property};

use super::super::{Animation, Curve, HermiteKey, Motion, Scene, SceneError};
use super::gltf_buffers::Buffers;

/// Frames a second.
const RATE: f64 = 30.0;

/// Adds what moves; `placed` are the scene's nodes by the document's, those that are shown.
pub(super) fn read(
    document: &gltf::Document,
    buffers: &Buffers<'_>,
    placed: &[Option<u32>],
    scene: &mut Scene,
) {
    let mut animations = document.animations();
    let Some(played) = animations.next() else { return };
    for other in animations {
        let name = other.name().unwrap_or("");
        scene.warnings.push(format!("animation {} {name:?} is not played: the first one is", other.index()));
    }
    let mut motions: BTreeMap<u32, Motion> = BTreeMap::new();
    let (mut start, mut end) = (f64::INFINITY, f64::NEG_INFINITY);
    for channel in played.channels() {
        let target = channel.target();
        if target.property() == Property::MorphTargetWeights {
            continue;
        }
        let Some(node) = placed.get(target.node().index()).copied().flatten() else { continue };
        let mut motion = motions.get(&node).cloned().unwrap_or_else(|| at_rest(&target.node()));
        let read = read_channel(&channel, buffers, &mut motion).map_err(|error| error.to_string());
        let sound = read.and_then(|times| match motion.check() {
            Ok(()) => Ok(times),
            Err((found, expected)) => Err(format!("{found}; expected {expected}")),
        });
        match sound {
            Ok(times) => {
                start = times.first().map_or(start, |first| start.min(f64::from(*first)));
                end = times.last().map_or(end, |last| end.max(f64::from(*last)));
                motions.insert(node, motion);
            }
            Err(fault) => {
                scene.warnings.push(format!("animation channel {} is left out: {fault}", channel.index()))
            }
        }
    }
    if motions.is_empty() {
        return;
    }
    let animation = &mut scene.animation;
    (animation.start, animation.end) = (start, end);
    animation.frames = frames(animation);
    for (number, (node, motion)) in (0..).zip(motions) {
        animation.followers.push((node, number));
        animation.motions.push(motion);
    }
}

/// How many frames an animation is given.
pub(super) fn frames(animation: &Animation) -> u32 {
    (((animation.end - animation.start) * RATE).ceil() as u32).saturating_add(1)
}

/// The node's own transform: what no channel changes stays.
fn at_rest(node: &gltf::Node<'_>) -> Motion {
    let (translation, rotation, scale) = node.transform().decomposed();
    let still = |value: [f32; 3]| Some(Curve::Steps(vec![(0.0, Vec3::from(value))]));
    Motion {
        name: node.name().unwrap_or("").to_owned(),
        translation: still(translation),
        rotation: Some(Curve::Steps(vec![(0.0, Quat::from_array(rotation))])),
        scale: still(scale),
        visibility: Vec::new(),
    }
}

/// Reads one of a motion's curves; tells the times of its keys.
fn read_channel(
    channel: &gltf::animation::Channel<'_>,
    buffers: &Buffers<'_>,
    motion: &mut Motion,
) -> Result<Vec<f32>, SceneError> {
    let sampler = channel.sampler();
    let (times, output) = (buffers.numbers(&sampler.input())?, sampler.output());
    let kind = sampler.interpolation();
    let vectors = || {
        let values = buffers.positions(&output)?.into_iter().map(Vec3::from).collect::<Vec<_>>();
        buffers.check_keys(&output, kind, &times, values.len())?;
        Ok::<_, SceneError>(curve(kind, &times, &values))
    };
    match channel.target().property() {
        Property::Translation => motion.translation = Some(vectors()?),
        Property::Scale => motion.scale = Some(vectors()?),
        Property::Rotation => {
            let values = buffers.fours(&output)?.into_iter().map(Quat::from_array).collect::<Vec<_>>();
            buffers.check_keys(&output, kind, &times, values.len())?;
            motion.rotation = Some(curve(kind, &times, &values));
        }
        // They bend the mesh and leave its node.
        Property::MorphTargetWeights => {}
    }
    Ok(times)
}

/// The curve through values, one for each time, or three: the slope come to it with, itself, the slope it is left with.
pub(super) fn curve<T: Copy>(kind: Interpolation, times: &[f32], values: &[T]) -> Curve<T> {
    let times = times.iter().map(|time| f64::from(*time));
    let pairs = || times.clone().zip(values.iter().copied()).collect();
    match kind {
        Interpolation::Linear => Curve::Linear(pairs()),
        Interpolation::Step => Curve::Steps(pairs()),
        Interpolation::CubicSpline => {
            let (triples, _) = values.as_chunks();
            let key = |(time, [arriving, value, leaving]): (f64, &[T; 3])| HermiteKey {
                time,
                value: *value,
                arriving: *arriving,
                leaving: *leaving,
            };
            Curve::Hermite(times.zip(triples).map(key).collect())
        }
    }
}

#[cfg(test)]
#[path = "gltf_motion_tests.rs"]
pub(super) mod tests;
