//! Where the moving body is in each frame: `job.place`. What was found is told in rows (`mover_x` to `mover_turn_z`).
//!
//! - `here`: where its scene has it.
//! - `gap`: beside the other along x, nearer by nothing than `job.gap` times the other's longest side.
//! - `apart`: where its scene has it, if nothing touches there; else as `deep`.
//! - `deep`: within the other without touching, where the descent is longest among places tried at random
//!   (P2-21: "spatially placed such that the algorithm is forced to traverse deep down in both trees").
//! - `graze`: it slides along the other past a touch, a thousandth of its side away, and then into it.

use super::Over;
use super::stage::Body;
use crate::geometry::{Aabb, Obb, Overlap, Rigid};
use crate::job::collide::{Query, contacts};
use crate::measure::MeasureError;
use crate::scene::SplitMix64;
use crate::structure::VolumeTree;
use glam::{DQuat, DVec3};

/// A kind of place, or of way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    Here,
    Apart,
    Gap(f64),
    Deep,
    Graze,
}

/// Places tried for `deep`.
const TRIES: usize = 4000;
/// Steps on the way in to the first touch.
const STEPS: u32 = 400;
/// Halvings of the way on which a gap is looked for: as near as f64 can tell.
const HALVINGS: usize = 40;
/// How near `graze` comes, in shares of the other's longest side, and how deep it gets in the end.
const GRAZE: f64 = 1e-3;
const INTO: f64 = 0.2;
/// How far `graze` turns on its way, radians.
const TURN: f64 = 0.5;
/// Leaves of the trees that places are found with.
const LEAF: usize = 4;

pub(super) fn poses(
    mover: &Body,
    other: &Body,
    over: Over,
    place: Place,
    frames: usize,
    seed: u64,
) -> Result<Vec<Rigid>, MeasureError> {
    Ok(match place {
        Place::Here => vec![Rigid::IDENTITY; frames],
        Place::Gap(gap) => {
            let place = beside(mover, other, DQuat::IDENTITY, gap)?;
            vec![about_middle(mover, DQuat::IDENTITY, place); frames]
        }
        Place::Apart => {
            let (moved, fixed) = trees::<Obb>(mover, other, Over::Triangles)?;
            let here = contacts(&fixed, &moved, &Rigid::IDENTITY, Query { first: true, reach: 0.0 });
            let pose = if here.pairs.is_empty() { Rigid::IDENTITY } else { deep(mover, other, over, seed)? };
            vec![pose; frames]
        }
        Place::Deep => vec![deep(mover, other, over, seed)?; frames],
        Place::Graze => {
            let side = longest(other);
            let turn = |share: f64| DQuat::from_rotation_y(TURN * share);
            let touch = beside(mover, other, turn(0.5), GRAZE)?;
            let pose = |frame: usize| {
                let share = frame as f64 / (frames - 1).max(1) as f64;
                // Along it up to the middle of the way, then into it.
                let (along, into) = ((1.0 - 2.0 * share).max(0.0), (2.0 * share - 1.0).max(0.0));
                let way = DVec3::new(-INTO * side * into, 0.0, -side * along);
                about_middle(mover, turn(share.min(0.5)), touch + way)
            };
            (0..frames).map(pose).collect()
        }
    })
}

fn longest(body: &Body) -> f64 {
    f64::from(body.scene.bounds().size().max_element())
}

type Pair<V> = (VolumeTree<V>, VolumeTree<V>);

fn trees<V: Overlap>(mover: &Body, other: &Body, over: Over) -> Result<Pair<V>, MeasureError> {
    Ok((mover.tree(over, LEAF)?, other.tree(over, LEAF)?))
}

/// A body turned about its own middle, and that brought to a place.
fn about_middle(body: &Body, turn: DQuat, place: DVec3) -> Rigid {
    Rigid::shift(-body.scene.bounds().centre().as_dvec3()).then(&Rigid::new(turn, place))
}

/// Where a body's middle is when it is beside the other along x, so far that nothing is nearer than `gap` times the
/// other's longest side.
fn beside(mover: &Body, other: &Body, turn: DQuat, gap: f64) -> Result<DVec3, MeasureError> {
    let (moved, fixed) = trees::<Obb>(mover, other, Over::Triangles)?;
    let (own, side) = (mover.scene.bounds(), longest(other));
    let to = other.scene.bounds().centre().as_dvec3();
    let at = |x: f64| about_middle(mover, turn, to + DVec3::X * x);
    let query = Query { first: true, reach: gap * side };
    let touches = |x: f64| !contacts(&fixed, &moved, &at(x), query).pairs.is_empty();
    // From afar inward to the first step that touches: further in there may be room again.
    let step = (side + f64::from(own.size().length()) + gap * side) / STEPS as f64;
    let first = (1..=STEPS).rev().map(|i| step * i as f64).find(|&x| touches(x - step));
    let Some(mut far) = first else {
        let message =
            format!("`{}` meets nothing of `{}` on its way in along x", mover.scene.name, other.scene.name);
        return Err(MeasureError::Failed(message));
    };
    let mut near = far - step;
    for _ in 0..HALVINGS {
        let x = (near + far) / 2.0;
        *(if touches(x) { &mut near } else { &mut far }) = x;
    }
    Ok(to + DVec3::X * far)
}

/// Within the other body, touching nothing, where the most boxes have to be tested to know it.
fn deep(mover: &Body, other: &Body, over: Over, seed: u64) -> Result<Rigid, MeasureError> {
    let (moved, fixed) = trees::<Aabb>(mover, other, over)?;
    let (own, around) = (mover.scene.bounds(), other.scene.bounds());
    let (low, high) = ((around.min - own.min).as_dvec3(), (around.max - own.max).as_dvec3());
    let mut random = SplitMix64::new(seed);
    let mut best = None;
    for _ in 0..TRIES {
        let mut share = || random.between(0.0, 1.0);
        let way = low + (high - low) * DVec3::new(share(), share(), share());
        let motion = Rigid::shift(way);
        let found = contacts(&fixed, &moved, &motion, Query { first: true, reach: 0.0 });
        if found.pairs.is_empty() && best.is_none_or(|(tests, _)| found.box_tests > tests) {
            best = Some((found.box_tests, motion));
        }
    }
    let (mover, other) = (&mover.scene.name, &other.scene.name);
    best.map(|(_, motion)| motion).ok_or_else(|| {
        let message = format!("no place for `{mover}` in `{other}` where nothing touches, in {TRIES} tries");
        MeasureError::Failed(message)
    })
}
