//! Polygons and triangles given one by one, gathered into meshes: those that stand in one place, and those that move
//! at the same times and look alike.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use super::super::super::{BendKey, Corners};
use super::keys;
use super::polygon::{self, Outline};
use super::statement::{Finish, Look, Parsed, Patch, Statement};
use super::words::{Fault, Words};

/// Stands for no normal and no texture coordinate.
const NONE: u32 = u32::MAX;

/// The patches that polygons are being added to.
#[derive(Default)]
pub(super) struct Faces {
    /// Of what stands still.
    still: Option<u32>,
    /// Of what moves.
    moving: Option<u32>,
    /// Polygons whose outline crosses itself.
    crossed: usize,
    /// The looks of `still`, by what they are.
    looks: HashMap<(Option<[u32; 13]>, Option<String>), u32>,
}

impl Faces {
    /// Reads a polygon after its keyword: after `p` and `pp` the number of corners, after `tt` and `ttp` three
    /// textured ones.
    pub(super) fn polygon(
        &mut self,
        words: &mut Words<'_>,
        look: Look,
        has_normals: bool,
        parsed: &mut Parsed,
    ) -> Result<(), Fault> {
        let at = words.start;
        let (count, room) = if look.texture.is_some() { (3, 3) } else { words.count(6)? };
        if count < 3 {
            return Err(words.wrong("at least 3 corners"));
        }
        let mut corners = Vec::with_capacity(room);
        let (mut normals, mut coordinates) = (Vec::new(), Vec::new());
        for _ in 0..count {
            corners.push(words.vector()?);
            if has_normals {
                normals.push(words.vector()?);
            }
            if look.texture.is_some() {
                coordinates.push(Vec2::new(words.number()?, words.number()?));
            }
        }
        let Outline { triangles, is_crossed } = polygon::triangulate(&corners).ok_or_else(|| {
            let most = polygon::MOST_CONCAVE;
            Fault::new(at, format!("{count} corners that are not convex"), format!("at most {most} of such"))
        })?;
        self.crossed += usize::from(is_crossed);
        let number = self.still(parsed);
        let patch = &mut parsed.patches[number as usize];
        let look = self.look(look, patch);
        let first = patch.positions.len() as u32;
        let placed = |first: u32| triangles.iter().map(move |triangle| triangle.map(|corner| corner + first));
        let add = |list: &mut Option<Vec<[u32; 3]>>, is_there: bool, first: usize| {
            let list = list.get_or_insert_default();
            match is_there {
                true => list.extend(placed(first as u32)),
                false => list.extend(triangles.iter().map(|_| [NONE; 3])),
            }
        };
        add(&mut patch.normals.triangles, has_normals, patch.normals.values.len());
        add(&mut patch.coordinates.triangles, !coordinates.is_empty(), patch.coordinates.values.len());
        patch.normals.values.append(&mut normals);
        patch.coordinates.values.append(&mut coordinates);
        patch.triangles.extend(placed(first));
        patch.look_of.extend(triangles.iter().map(|_| look));
        patch.positions.append(&mut corners);
        Ok(())
    }

    /// Reads a triangle that moves, after its keyword.
    pub(super) fn bend(
        &mut self,
        words: &mut Words<'_>,
        look: Look,
        parsed: &mut Parsed,
    ) -> Result<(), Fault> {
        // A time and eighteen numbers.
        let (count, room) = words.count(38)?;
        if count == 0 {
            return Err(words.wrong("at least 1 key"));
        }
        let mut keys: Vec<(f64, [[Vec3; 2]; 3])> = Vec::with_capacity(room);
        for _ in 0..count {
            let time = keys::time(words, keys.last().map(|key| key.0))?;
            let mut corner = || Ok([words.vector()?, words.vector()?]);
            keys.push((time, [corner()?, corner()?, corner()?]));
        }
        let continues = self.moving.filter(|number| {
            let patch = &parsed.patches[*number as usize];
            let times = patch.keys.iter().map(|key| key.time);
            patch.looks[0] == look && times.eq(keys.iter().map(|key| key.0))
        });
        let number = continues.unwrap_or_else(|| {
            self.end_moving(parsed);
            let blank = |time| BendKey { time, positions: Vec::new(), normals: Vec::new() };
            let bends = keys.iter().map(|key| blank(key.0)).collect();
            begin(parsed, Patch { looks: vec![look], keys: bends, ..Patch::default() })
        });
        self.moving = Some(number);
        let patch = &mut parsed.patches[number as usize];
        let first = patch.triangles.len() as u32 * 3;
        patch.triangles.push([first, first + 1, first + 2]);
        for (bend, (_, corners)) in patch.keys.iter_mut().zip(keys) {
            bend.positions.extend(corners.map(|[position, _]| position));
            bend.normals.extend(corners.map(|[_, normal]| normal));
        }
        Ok(())
    }

    /// Ends the meshes in hand.
    pub(super) fn end(&mut self, parsed: &mut Parsed) {
        if let Some(number) = self.still.take() {
            let patch = &mut parsed.patches[number as usize];
            shorten(&mut patch.normals, &patch.triangles);
            shorten(&mut patch.coordinates, &patch.triangles);
            if patch.looks.len() == 1 {
                patch.look_of = Vec::new();
            }
            self.looks.clear();
        }
        self.end_moving(parsed);
        let crossed = std::mem::take(&mut self.crossed);
        if crossed > 0 {
            let told = format!("{crossed} polygons of {:?} cross themselves: cut up anyhow", parsed.stem);
            parsed.warnings.push(told);
        }
    }

    fn end_moving(&mut self, parsed: &mut Parsed) {
        if let Some(number) = self.moving.take() {
            let patch = &mut parsed.patches[number as usize];
            // It stands in the scene as its first key has it.
            patch.positions.clone_from(&patch.keys[0].positions);
            patch.normals = Corners::of_vertices(patch.keys[0].normals.clone());
        }
    }

    fn still(&mut self, parsed: &mut Parsed) -> u32 {
        *self.still.get_or_insert_with(|| begin(parsed, Patch::default()))
    }

    /// The number of a look among those of the patch.
    fn look(&mut self, look: Look, patch: &mut Patch) -> u32 {
        if patch.looks.last() == Some(&look) {
            return patch.looks.len() as u32 - 1;
        }
        let key = (look.finish.as_ref().map(Finish::key), look.texture.clone());
        *self.looks.entry(key).or_insert_with(|| {
            patch.looks.push(look);
            patch.looks.len() as u32 - 1
        })
    }
}

/// A patch that stands in its statement's place from its first triangle on.
fn begin(parsed: &mut Parsed, patch: Patch) -> u32 {
    let number = parsed.add_patch(patch);
    parsed.statements.push(Statement::Patch(number));
    number
}

/// No list where there is nothing, or where it says the same as the triangles.
fn shorten<T>(corners: &mut Corners<T>, triangles: &[[u32; 3]]) {
    if corners.values.is_empty() || corners.triangles.as_deref() == Some(triangles) {
        corners.triangles = None;
    }
}
