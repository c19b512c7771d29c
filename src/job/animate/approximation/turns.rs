//! Which pixels are traced in a frame when only a part of them is.

/// The sixteen pixels of a square in an order in which those that follow one another are far apart (the ordered dither
/// of Bayer 1973).
const ORDER: [[u32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// Parts of the picture that take turns.
pub(super) const PARTS: u32 = 16;

/// Whether it is a pixel's turn in a frame, of which so many of [`PARTS`] have theirs. The parts of one frame follow those of the one
/// before, so none waits longer than it must.
pub(super) fn has_turn((x, y): (u32, u32), frame: u32, parts: u32) -> bool {
    let first = frame.wrapping_mul(parts) % PARTS;
    (ORDER[y as usize % 4][x as usize % 4] + PARTS - first) % PARTS < parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_has_its_turn_as_often_as_any_other() {
        for parts in 1..=PARTS {
            let mut turns = [0; 16];
            for frame in 0..PARTS {
                let now: Vec<usize> = (0..16)
                    .filter(|at| has_turn((4 + at % 4, 8 + at / 4), frame, parts))
                    .map(|at| at as usize)
                    .collect();
                assert_eq!(now.len(), parts as usize, "as many each frame");
                now.into_iter().for_each(|at| turns[at] += 1);
            }
            assert_eq!(turns, [parts; 16]);
        }
    }
}
