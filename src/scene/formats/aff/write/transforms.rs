//! Transforms as `xs`: scaled, turned, moved. What is sheared as well takes two, as every matrix is a turn, a scale
//! and a turn again (its singular value decomposition, by Jacobi's rotations).

use std::fmt::Write as _;

use glam::{Affine3A, DMat3, DQuat, DVec3};

use super::Out;

/// The greatest cosine between axes that counts as none: rounding to f32 makes about 1e-7.
const SQUARE: f64 = 1e-6;
/// The least share of the longest axis that another must reach to have a direction of its own.
const TELLING: f64 = 1e-9;

impl Out {
    /// Opens a transform, and returns how many braces that took: none if nothing is transformed.
    pub(super) fn transform(&mut self, transform: &Affine3A) -> usize {
        if *transform == Affine3A::IDENTITY {
            return 0;
        }
        let matrix = DMat3::from_cols(
            transform.matrix3.x_axis.as_dvec3(),
            transform.matrix3.y_axis.as_dvec3(),
            transform.matrix3.z_axis.as_dvec3(),
        );
        let parts = Parts::of(matrix);
        self.open(parts.scale, parts.turn, transform.translation.as_dvec3());
        match parts.first {
            Some(first) => {
                self.open(DVec3::ONE, first, DVec3::ZERO);
                2
            }
            None => 1,
        }
    }

    fn open(&mut self, scale: DVec3, turn: DQuat, translation: DVec3) {
        self.text.push_str("xs");
        self.doubles(scale);
        self.turn(turn);
        self.doubles(translation);
        self.text.push_str(" {\n");
    }

    /// Axis and angle in degrees, up to twice around, so that the same quaternion is read back.
    pub(super) fn turn(&mut self, turn: DQuat) {
        let axis = turn.xyz();
        let degrees = 2.0 * axis.length().atan2(turn.w).to_degrees();
        self.doubles(axis.normalize_or(DVec3::Z));
        let _ = write!(self.text, " {degrees}");
    }
}

/// A matrix is `turn * scale * first`.
struct Parts {
    turn: DQuat,
    scale: DVec3,
    first: Option<DQuat>,
}

impl Parts {
    fn of(matrix: DMat3) -> Self {
        let axes = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
        let cosine = |a: DVec3, b: DVec3| a.normalize_or_zero().dot(b.normalize_or_zero()).abs();
        let [x, y, z] = axes;
        if cosine(x, y).max(cosine(y, z)).max(cosine(z, x)) <= SQUARE {
            let (turn, scale) = stretched(axes);
            return Self { turn, scale, first: None };
        }
        let first = square_axes(matrix);
        let (turn, scale) = stretched([first.x_axis, first.y_axis, first.z_axis].map(|axis| matrix * axis));
        Self { turn, scale, first: Some(DQuat::from_mat3(&first.transpose())) }
    }
}

/// The turn that lays the axes in these directions, which are square to one another, and how far each then reaches;
/// of what is mirrored one reaches backwards.
fn stretched(axes: [DVec3; 3]) -> (DQuat, DVec3) {
    let lengths = axes.map(DVec3::length);
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| lengths[*b].total_cmp(&lengths[*a]));
    // The two longest tell all three directions. What is far shorter than the longest has none, but that of rounding.
    let [longest, middle, shortest] = order;
    let mut units = [axes[longest].normalize_or(DVec3::AXES[longest]); 3];
    let rest = axes[middle] - units[longest] * units[longest].dot(axes[middle]);
    let has_direction = rest.length() > TELLING * lengths[longest];
    units[middle] = if has_direction { rest.normalize() } else { units[longest].any_orthonormal_vector() };
    units[shortest] = units[(shortest + 1) % 3].cross(units[(shortest + 2) % 3]);
    let scale = DVec3::from_array([0, 1, 2].map(|axis| units[axis].dot(axes[axis])));
    (DQuat::from_mat3(&DMat3::from_cols(units[0], units[1], units[2])), scale)
}

/// The turn whose axes the matrix leaves square to one another: the eigenvectors of its square.
fn square_axes(matrix: DMat3) -> DMat3 {
    let (mut square, mut axes) = (matrix.transpose() * matrix, DMat3::IDENTITY);
    // Each round over the three pairs squares what is left; six are more than f64 can tell.
    for (p, q) in [(0, 1), (1, 2), (0, 2)].into_iter().cycle().take(18) {
        let angle = 0.5 * (2.0 * square.col(q)[p]).atan2(square.col(p)[p] - square.col(q)[q]);
        let (sine, cosine) = angle.sin_cos();
        let mut turn = DMat3::IDENTITY;
        turn.col_mut(p)[p] = cosine;
        turn.col_mut(p)[q] = sine;
        turn.col_mut(q)[p] = -sine;
        turn.col_mut(q)[q] = cosine;
        square = turn.transpose() * square * turn;
        axes *= turn;
    }
    axes
}
