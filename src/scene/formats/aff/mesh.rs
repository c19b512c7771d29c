//! `m`: meshes by index, with normals and texture coordinates of their own.

use glam::{Vec2, Vec3};

use super::super::super::Corners;
use super::statement::{Finish, Look, Patch};
use super::words::{Fault, Words};

/// The least that a number takes, with the blank after it.
const NUMBER: usize = 2;

/// Reads a mesh after its keyword.
pub(super) fn read(words: &mut Words<'_>, finish: Option<Finish>) -> Result<Patch, Fault> {
    words.expect("vertices")?;
    let positions = list(words, 3, Words::vector)?;
    let mut normals: Option<Vec<Vec3>> = None;
    let mut coordinates: Option<Vec<Vec2>> = None;
    let mut texture = None;
    if words.peek() == Some(b"normals") {
        words.next();
        normals = Some(list(words, 3, Words::vector)?);
    }
    if words.peek() == Some(b"texturecoords") {
        words.next();
        let (count, room) = words.count(2 * NUMBER)?;
        texture = Some(words.name("a texture's file")?.to_owned());
        let mut values = Vec::with_capacity(room);
        for _ in 0..count {
            values.push(Vec2::new(words.number()?, words.number()?));
        }
        coordinates = Some(values);
    }
    if words.next() != Some(b"triangles") {
        let before = if normals.is_none() && coordinates.is_none() { "`normals`, " } else { "" };
        let also = if coordinates.is_none() { "`texturecoords` or " } else { "" };
        return Err(words.wrong(format!("{before}{also}`triangles`")));
    }
    let (count, room) = words.count(3 * NUMBER)?;
    let mut triangles = Vec::with_capacity(room);
    let reserved = |is_there: bool| Vec::with_capacity(if is_there { room } else { 0 });
    let (mut by_normal, mut by_coordinate) = (reserved(normals.is_some()), reserved(coordinates.is_some()));
    for _ in 0..count {
        triangles.push(corners(words, positions.len(), "vertices")?);
        if let Some(normals) = &normals {
            by_normal.push(corners(words, normals.len(), "normals")?);
        }
        if let Some(coordinates) = &coordinates {
            by_coordinate.push(corners(words, coordinates.len(), "texture coordinates")?);
        }
    }
    Ok(Patch {
        normals: normals.map_or_else(Corners::default, |values| gathered(values, by_normal, &triangles)),
        coordinates: coordinates
            .map_or_else(Corners::default, |values| gathered(values, by_coordinate, &triangles)),
        positions,
        triangles,
        looks: vec![Look { finish, texture }],
        ..Patch::default()
    })
}

/// A count, and so many items of a few numbers each.
fn list<'a, T>(
    words: &mut Words<'a>,
    numbers: usize,
    item: impl Fn(&mut Words<'a>) -> Result<T, Fault>,
) -> Result<Vec<T>, Fault> {
    let (count, room) = words.count(numbers * NUMBER)?;
    let mut list = Vec::with_capacity(room);
    for _ in 0..count {
        list.push(item(words)?);
    }
    Ok(list)
}

/// Three indices below a count.
fn corners(words: &mut Words<'_>, count: usize, what: &str) -> Result<[u32; 3], Fault> {
    let mut corners = [0; 3];
    for corner in &mut corners {
        *corner = words.whole()?;
        if *corner as usize >= count {
            return Err(words.wrong(format!("an index below {count}, the number of {what}")));
        }
    }
    Ok(corners)
}

/// Without a list of its own where it would say the same as the triangles.
fn gathered<T>(values: Vec<T>, by_value: Vec<[u32; 3]>, triangles: &[[u32; 3]]) -> Corners<T> {
    let triangles = (by_value != triangles).then_some(by_value);
    Corners { values, triangles }
}
