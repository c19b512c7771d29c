//! Triangles against triangles in whole numbers.
//!
//! Two triangles meet exactly if the origin lies in the hull of the nine differences of their corners; and if it
//! does, it lies in the simplex of some four, three or two of them that do not lie in less, or is one of them
//! (Caratheodory). All are tried, in integers that cannot overflow; none if some direction is seen along which all nine
//! lie on one side of the origin, which whatever direction it is shows that they do not surround it.

/// A corner on a grid; each coordinate at most 2^19 in size.
pub type GridPoint = [i32; 3];

/// Whether two triangles, which may be flat, have a point in common.
///
/// # Panics
/// If a coordinate is larger than 2^19.
pub fn triangles_meet(a: &[GridPoint; 3], b: &[GridPoint; 3]) -> bool {
    let large = a.iter().chain(b).flatten().any(|coordinate| coordinate.unsigned_abs() > 1 << 19);
    assert!(!large, "a coordinate beyond the grid: {a:?} {b:?}");
    let all: Vec<[i128; 3]> = a
        .iter()
        .flat_map(|p| b.iter().map(|q| [0, 1, 2].map(|k| i128::from(p[k]) - i128::from(q[k]))))
        .collect();
    let beside = |way: [i128; 3]| {
        let side = dot(way, all[0]).signum();
        side != 0 && all.iter().all(|at| dot(way, *at).signum() == side)
    };
    if [[1, 0, 0], [0, 1, 0], [0, 0, 1]].into_iter().chain(likely(a, b)).any(beside) {
        return false;
    }
    let n = all.len();
    (0..n).any(|i| {
        all[i] == [0; 3]
            || (i + 1..n).any(|j| {
                segment_holds_origin(all[i], all[j])
                    || (j + 1..n).any(|k| {
                        triangle_holds_origin([all[i], all[j], all[k]])
                            || (k + 1..n).any(|l| tetrahedron_holds_origin([all[i], all[j], all[k], all[l]]))
                    })
            })
    })
}

/// Directions along which most that are apart are seen to be: across the planes of both, and across pairs of edges.
fn likely(a: &[GridPoint; 3], b: &[GridPoint; 3]) -> impl Iterator<Item = [i128; 3]> {
    let edges = |t: &[GridPoint; 3]| {
        let t = t.map(|corner| corner.map(i128::from));
        [sub(t[1], t[0]), sub(t[2], t[1]), sub(t[0], t[2])]
    };
    let (a, b) = (edges(a), edges(b));
    let planes = [cross(a[0], a[1]), cross(b[0], b[1])];
    planes.into_iter().chain(a.into_iter().flat_map(move |s| b.map(|t| cross(s, t))))
}

fn cross(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [i128; 3], b: [i128; 3]) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn sub(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn segment_holds_origin(a: [i128; 3], b: [i128; 3]) -> bool {
    cross(a, b) == [0; 3] && dot(a, b) <= 0
}

/// False for a flat one: its edges are asked as well.
fn triangle_holds_origin([a, b, c]: [[i128; 3]; 3]) -> bool {
    let normal = cross(sub(b, a), sub(c, a));
    let turns = [[a, b], [b, c], [c, a]].map(|[u, v]| dot(cross(u, v), normal));
    normal != [0; 3] && dot(normal, a) == 0 && turns.iter().all(|turn| *turn >= 0)
}

/// False for a flat one: its faces are asked as well.
fn tetrahedron_holds_origin(corners: [[i128; 3]; 4]) -> bool {
    let volume = |[a, b, c, d]: [[i128; 3]; 4]| dot(cross(sub(b, a), sub(c, a)), sub(d, a)).signum();
    let whole = volume(corners);
    whole != 0
        && (0..4).all(|i| {
            let mut with_origin = corners;
            with_origin[i] = [0; 3];
            volume(with_origin) * whole >= 0
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_one_can_see() {
        let flat = [[0, 0, 0], [4, 0, 0], [0, 4, 0]];
        let through = [[1, 1, -1], [1, 1, 1], [9, 9, 0]];
        let above = [[0, 0, 1], [4, 0, 1], [0, 4, 1]];
        let corner = [[4, 0, 0], [8, 0, 3], [8, 1, -3]];
        assert!(
            triangles_meet(&flat, &through) && triangles_meet(&flat, &corner) && triangles_meet(&flat, &flat)
        );
        assert!(!triangles_meet(&flat, &above));
        // In one plane: one within the other, and beside it.
        assert!(triangles_meet(&flat, &[[1, 1, 0], [2, 1, 0], [1, 2, 0]]));
        assert!(!triangles_meet(&flat, &[[3, 3, 0], [5, 3, 0], [3, 5, 0]]));
        // A point and a needle.
        assert!(triangles_meet(&flat, &[[1, 1, 0]; 3]) && !triangles_meet(&flat, &[[1, 1, 1]; 3]));
        assert!(triangles_meet(&flat, &[[1, 1, -5], [1, 1, 5], [1, 1, 0]]));
    }
}
