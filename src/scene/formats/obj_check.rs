//! A look over an OBJ file before crate `tobj` reads it. `tobj` names no line in its errors, takes NaN
//! for a number and, on wild indices, can overflow; it looks for the colour of every vertex if one has
//! any. Here each line that bears on geometry is checked.

use super::super::SceneError;

/// How many positions, texture coordinates and normals have been given so far.
type Counts = [usize; 3];

/// Checks all `v`, `vt`, `vn`, `f` and `l` lines.
///
/// # Errors
/// [`SceneError::Malformed`] with the number of the first line that is not right.
pub(super) fn check(file: &str, text: &str) -> Result<(), SceneError> {
    let mut counts = [0; 3];
    let mut coloured = 0;
    for (number, line) in text.lines().enumerate() {
        let checked =
            check_line(line, &mut counts).and_then(|kind| check_colour(kind, counts[0], &mut coloured));
        checked.map_err(|(found, expected)| {
            SceneError::malformed(file, format!("line {}", number + 1), found, expected)
        })?;
    }
    Ok(())
}

/// What a line was, as far as it bears on geometry.
enum Line {
    /// A vertex, with a colour or without.
    Vertex {
        has_colour: bool,
    },
    Other,
}

fn check_line(line: &str, counts: &mut Counts) -> Result<Line, (String, String)> {
    let mut words = line.split_whitespace();
    let (kind, least) = match words.next() {
        Some("v") => (0, 3),
        Some("vt") => (1, 2),
        Some("vn") => (2, 3),
        Some("f" | "l") if words.clone().next().is_none() => {
            return Err(("no corners".to_string(), "vertex indices".to_string()));
        }
        Some("f" | "l") => {
            return words.try_for_each(|corner| check_corner(corner, counts)).map(|()| Line::Other);
        }
        _ => return Ok(Line::Other),
    };
    let numbers: Vec<&str> = words.collect();
    if numbers.len() < least {
        return Err((format!("{} numbers", numbers.len()), format!("at least {least}")));
    }
    for number in &numbers {
        if !number.parse::<f32>().is_ok_and(f32::is_finite) {
            return Err((format!("{number:?}"), "a finite number".to_string()));
        }
    }
    if kind == 0 && !matches!(numbers.len(), 3 | 4 | 6) {
        let expected = "x y z, x y z w or x y z r g b".to_string();
        return Err((format!("{} numbers", numbers.len()), expected));
    }
    if kind == 0 && numbers.len() == 4 && numbers[3].parse::<f32>() == Ok(0.0) {
        return Err(("w is 0".to_string(), "a divisor".to_string()));
    }
    counts[kind] += 1;
    Ok(if kind == 0 { Line::Vertex { has_colour: numbers.len() == 6 } } else { Line::Other })
}

/// Checks that of the vertices up to this one all have a colour or none has.
fn check_colour(line: Line, vertices: usize, coloured: &mut usize) -> Result<(), (String, String)> {
    let Line::Vertex { has_colour } = line else { return Ok(()) };
    *coloured += usize::from(has_colour);
    if *coloured == 0 || *coloured == vertices {
        return Ok(());
    }
    let found = if has_colour { "a vertex with a colour" } else { "a vertex without a colour" };
    Err((found.to_string(), "a colour for all vertices or for none".to_string()))
}

/// Checks a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`; indices count from 1, or back from -1.
fn check_corner(corner: &str, counts: &Counts) -> Result<(), (String, String)> {
    let names = ["vertex", "texture coordinate", "normal"];
    for (part, index) in corner.split('/').enumerate() {
        let Some(count) = counts.get(part) else {
            return Err((format!("corner {corner:?}"), "at most v/vt/vn".to_string()));
        };
        if index.is_empty() && part > 0 {
            continue;
        }
        let in_range =
            index.parse::<i64>().is_ok_and(|index| index != 0 && index.unsigned_abs() <= *count as u64);
        if !in_range {
            let expected = format!("a {} index among the {count} given so far", names[part]);
            return Err((format!("corner {corner:?}"), expected));
        }
    }
    Ok(())
}
