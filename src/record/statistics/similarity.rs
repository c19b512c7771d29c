//! How alike two pictures look (Wang, Bovik, Sheikh and Simoncelli, "Image Quality Assessment: From Error Visibility to
//! Structural Similarity", 2004): kinder than an error to what is only a little brighter or off by a pixel (P3-F08).
//!
//! Departures: windows are even, 8 x 8 pixels, at every place, where the paper ends up with round ones of 11; colours
//! are seen as their luma alone (Rec. 709, of the codes in a file). Written here because of the crates that have it one
//! is under the AGPL, one sums where it should average, and others bring a dozen crates along or are not in Rust.

/// Edge of a window, in pixels.
const WINDOW: usize = 8;
/// The constants of the paper, for luma from 0 to [`WHITE`].
const C1: f64 = 0.01 * WHITE * 0.01 * WHITE;
const C2: f64 = 0.03 * WHITE * 0.03 * WHITE;
/// The weights of red, green and blue add up to 256.
const WEIGHTS: [u64; 3] = [54, 183, 19];
const WHITE: f64 = 255.0 * 256.0;

/// The mean structural similarity of two pictures of so many pixels across, 8 bits a colour: 1 for the same, about 0 for
/// unlike ones, below 0 for one's negative. None of pictures of different sizes, without a pixel, or not so wide.
///
/// A picture narrower than a window is all one window across.
pub fn structural_similarity(picture: &[u8], reference: &[u8], width: usize) -> Option<f64> {
    if picture.len() != reference.len() || picture.is_empty() || !picture.len().is_multiple_of(3 * width) {
        return None;
    }
    let height = picture.len() / 3 / width;
    let [a, b] = [picture, reference].map(luma);
    let products = |a: &[u64], b: &[u64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<_>>();
    let squares = [products(&a, &a), products(&b, &b), products(&a, &b)];
    // Sums are whole numbers, exact whatever their order: 2^28 pixels of 2^32 fit.
    let [a, b] = [a, b].map(|values| summed(&values, width));
    let [aa, bb, ab] = squares.map(|values| summed(&values, width));
    let (across, down) = (WINDOW.min(width), WINDOW.min(height));
    let count = (across * down) as f64;
    let mut total = 0.0;
    for (top, left) in (0..=height - down).flat_map(|top| (0..=width - across).map(move |left| (top, left))) {
        let at = |y: usize, x: usize| (top + y) * (width + 1) + left + x;
        let mean = |sums: &[u64]| {
            let whole = sums[at(down, across)] + sums[at(0, 0)];
            (whole - sums[at(0, across)] - sums[at(down, 0)]) as f64 / count
        };
        let (a, b) = (mean(&a), mean(&b));
        let [of_a, of_b, of_both] = [mean(&aa) - a * a, mean(&bb) - b * b, mean(&ab) - a * b];
        let same = (2.0 * a * b + C1) * (2.0 * of_both + C2);
        total += same / ((a * a + b * b + C1) * (of_a + of_b + C2));
    }
    Some(total / ((height - down + 1) * (width - across + 1)) as f64)
}

fn luma(picture: &[u8]) -> Vec<u64> {
    let (pixels, _) = picture.as_chunks::<3>();
    let of =
        |pixel: &[u8; 3]| pixel.iter().zip(WEIGHTS).map(|(part, weight)| u64::from(*part) * weight).sum();
    pixels.iter().map(of).collect()
}

/// For each corner between pixels the sum of all above and left of it (Crow 1984).
fn summed(values: &[u64], width: usize) -> Vec<u64> {
    let mut sums = vec![0; width + 1];
    for row in values.chunks_exact(width) {
        let above = sums.len() - width - 1;
        let mut along = 0;
        sums.push(0);
        for (x, value) in row.iter().enumerate() {
            along += value;
            sums.push(sums[above + x + 1] + along);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stripes of some width and a little noise.
    fn stripes(width: usize, height: usize, shift: usize) -> Vec<u8> {
        let pixel = |x: usize, y: usize| {
            let bright = ((x + shift) / 5).is_multiple_of(2);
            let noise = ((((x + shift) * 31 + y * 17) * 2_654_435_761) >> 7) & 15;
            let code = if bright { 180 } else { 60 } + noise as u8;
            [code, code / 2, 255 - code]
        };
        (0..height).flat_map(|y| (0..width).flat_map(move |x| pixel(x, y))).collect()
    }

    /// By the definition: every window gone through, pixel by pixel.
    fn slow(a: &[u8], b: &[u8], width: usize) -> f64 {
        let height = a.len() / 3 / width;
        let value = |picture: &[u8], x: usize, y: usize| {
            let [r, g, b] = [0, 1, 2].map(|part| f64::from(picture[3 * (y * width + x) + part]));
            (54.0 * r + 183.0 * g + 19.0 * b) / 256.0
        };
        let (across, down) = (8.min(width), 8.min(height));
        let (mut total, mut windows) = (0.0, 0.0);
        for (top, left) in (0..=height - down).flat_map(|y| (0..=width - across).map(move |x| (y, x))) {
            let cells: Vec<(f64, f64)> = (0..down)
                .flat_map(|y| (0..across).map(move |x| (left + x, top + y)))
                .map(|(x, y)| (value(a, x, y), value(b, x, y)))
                .collect();
            let mean =
                |of: &dyn Fn(&(f64, f64)) -> f64| cells.iter().map(of).sum::<f64>() / cells.len() as f64;
            let (ma, mb) = (mean(&|c| c.0), mean(&|c| c.1));
            let (va, vb) = (mean(&|c| (c.0 - ma).powi(2)), mean(&|c| (c.1 - mb).powi(2)));
            let both = mean(&|c| (c.0 - ma) * (c.1 - mb));
            let (c1, c2) = ((0.01 * 255.0_f64).powi(2), (0.03 * 255.0_f64).powi(2));
            total += (2.0 * ma * mb + c1) * (2.0 * both + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
            windows += 1.0;
        }
        total / windows
    }

    #[test]
    fn it_is_the_definitions() {
        for (width, height) in [(40, 23), (8, 8), (9, 30), (5, 40), (40, 3), (1, 1)] {
            let (a, b) = (stripes(width, height, 0), stripes(width, height, 2));
            let (found, expected) = (structural_similarity(&a, &b, width).unwrap(), slow(&a, &b, width));
            assert!((found - expected).abs() < 1e-9, "{width} x {height}: {found} {expected}");
        }
    }

    #[test]
    fn the_same_is_1_a_negative_below_0_and_black_for_white_about_0() {
        let a = stripes(32, 32, 0);
        assert!((structural_similarity(&a, &a, 32).unwrap() - 1.0).abs() < 1e-12);
        let negative: Vec<u8> = a.iter().map(|code| 255 - code).collect();
        assert!(structural_similarity(&a, &negative, 32).unwrap() < -0.5);
        let found = structural_similarity(&[0; 300], &[255; 300], 10).unwrap();
        assert!(found > 0.0 && found < 1e-3, "{found}");
    }

    #[test]
    fn a_little_brighter_looks_nearly_the_same_and_noise_of_the_same_error_does_not() {
        let a = stripes(64, 64, 0);
        let brighter: Vec<u8> = a.iter().map(|code| code.saturating_add(10)).collect();
        let noisy: Vec<u8> = a
            .iter()
            .enumerate()
            .map(|(at, code)| {
                // The same for a pixel's three colours, so that the luma changes as much.
                if (at / 3 * 2_654_435_761) >> 9 & 1 == 0 {
                    code.saturating_add(10)
                } else {
                    code.saturating_sub(10)
                }
            })
            .collect();
        let error = |b: &[u8]| super::super::mean_square_error(b, &a).unwrap();
        assert!((error(&brighter) / error(&noisy) - 1.0).abs() < 0.1);
        let [light, noise] = [&brighter, &noisy].map(|b| structural_similarity(b, &a, 64).unwrap());
        assert!(light > 0.98 && noise < light - 0.02, "{light} {noise}");
    }

    #[test]
    fn unlike_sizes_have_none() {
        assert_eq!(structural_similarity(&[0; 12], &[0; 9], 2), None);
        assert_eq!(structural_similarity(&[], &[], 2), None);
        assert_eq!(structural_similarity(&[0; 12], &[0; 12], 0), None);
        assert_eq!(structural_similarity(&[0; 12], &[0; 12], 3), None);
    }
}
