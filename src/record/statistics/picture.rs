//! How far a picture is from the one it should be (Lext, Assarsson and Möller 2001, Approximating algorithms; P3-13).
//! Pictures are the codes of files, 8 bits a colour: what a person is shown.
//!
//! None of this is what a person sees: a picture one pixel to the side looks the same and counts as bad (P3-F08), and
//! only pictures of one renderer can be compared (P3-F12).

/// The mean square error of a picture against its reference, colours from 0 to 1 (eq. 4): from 0, the same, to 1,
/// black for white. None of pictures of different sizes, or without a pixel. Exact but for its last division, so that
/// it is 0 for equal pictures alone.
pub fn mean_square_error(picture: &[u8], reference: &[u8]) -> Option<f64> {
    if picture.len() != reference.len() || picture.is_empty() {
        return None;
    }
    let squares = picture.iter().zip(reference).map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2));
    Some(squares.sum::<u64>() as f64 / (255.0 * 255.0 * picture.len() as f64))
}

/// The peak noise to signal ratio of a mean square error, in dB (eq. 5): 0 at worst, infinite where there is no error;
/// none of what is no error at all, below 0 or NaN.
pub fn pnsr(error: f64) -> Option<f64> {
    // + 0: an error of 1 has a ratio of 0, not of -0.
    (error >= 0.0).then(|| -10.0 * error.log10() + 0.0)
}

/// The ratio of the mean of all frames' mean square errors, in dB (eq. 6), which is not the mean of their ratios: one
/// bad frame is not made up for. None without frames.
pub fn average_pnsr(errors: &[f64]) -> Option<f64> {
    pnsr(errors.iter().sum::<f64>() / errors.len() as f64)
}

/// The ratio, in dB, of the least error a picture of so many pixels can have: one colour of one pixel off by its last
/// bit. None without a pixel.
pub fn least_error_pnsr(pixels: u64) -> Option<f64> {
    (pixels > 0).then(|| 10.0 * (255.0 * 255.0 * 3.0 * pixels as f64).log10())
}

/// Where a picture of so many pixels without any error is drawn on an axis of ratios, in dB: the next whole ten at least
/// 1 dB above the least error's. It is the paper's 120 at the paper's 1280 x 1024; a fixed 120 would call real errors
/// none beyond 5.13 million pixels (P3-F09). None without a pixel.
pub fn error_free_pnsr(pixels: u64) -> Option<f64> {
    least_error_pnsr(pixels).map(|least| ((least + 1.0) / 10.0).ceil() * 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_figures_come_out() {
        // One last bit at 1280 x 1024: "114"; at 3840 x 2160 and at 800 x 600 as P3-F09 has them.
        for (width, height, least, free) in
            [(1280, 1024, 114.08, 120.0), (3840, 2160, 122.08, 130.0), (800, 600, 109.72, 120.0)]
        {
            let mut picture = vec![77; 3 * width * height];
            let reference = picture.clone();
            picture[width * height] += 1;
            let ratio = pnsr(mean_square_error(&picture, &reference).unwrap()).unwrap();
            let pixels = (width * height) as u64;
            assert!((ratio - least).abs() < 0.01, "{ratio}");
            assert!((ratio - least_error_pnsr(pixels).unwrap()).abs() < 1e-9);
            assert_eq!(error_free_pnsr(pixels), Some(free));
        }
        // The least error of all sizes lies below where none is drawn, and within 11 dB of it.
        for pixels in (0..28).map(|bits| 1 << bits).chain([5_130_000, 1]) {
            let gap = error_free_pnsr(pixels).unwrap() - least_error_pnsr(pixels).unwrap();
            assert!((1.0..11.0).contains(&gap), "{pixels}: {gap}");
        }
    }

    #[test]
    fn none_and_no_error_and_the_worst_are_told_apart() {
        let (white, black) = ([255; 12], [0; 12]);
        assert_eq!(mean_square_error(&white, &black), Some(1.0));
        assert_eq!(pnsr(1.0).map(f64::to_bits), Some(0.0_f64.to_bits()));
        assert_eq!(mean_square_error(&white, &white), Some(0.0));
        assert_eq!(pnsr(0.0), Some(f64::INFINITY));
        assert_eq!(mean_square_error(&white, &black[..9]), None);
        assert_eq!(mean_square_error(&[], &[]), None);
        assert_eq!(
            (pnsr(f64::NAN), pnsr(-0.1), least_error_pnsr(0), error_free_pnsr(0)),
            (None, None, None, None)
        );
    }

    #[test]
    fn errors_agree_with_the_formula_as_it_is_printed() {
        let codes = |seed: u32| -> Vec<u8> {
            (0..300u32).map(|at| (at.wrapping_mul(2_654_435_761).wrapping_add(seed) >> 24) as u8).collect()
        };
        let (a, c) = (codes(1), codes(99_999_999));
        let part = |code: u8| f64::from(code) / 255.0;
        let mut sum = 0.0;
        for pixel in 0..100 {
            for colour in 0..3 {
                sum += (part(a[3 * pixel + colour]) - part(c[3 * pixel + colour])).powi(2);
            }
        }
        let expected = sum / (3.0 * 100.0);
        let found = mean_square_error(&a, &c).unwrap();
        assert!(expected > 0.01 && (found - expected).abs() < 1e-12 * expected, "{found} {expected}");
        assert!((pnsr(found).unwrap() - 10.0 * (1.0 / expected).log10()).abs() < 1e-9);
    }

    #[test]
    fn one_bad_frame_outweighs_many_good_ones() {
        let errors = [1e-2, 0.0, 0.0, 0.0];
        assert!((average_pnsr(&errors).unwrap() - 26.0206).abs() < 1e-4, "10 log10 400");
        assert_eq!(average_pnsr(&[0.0; 3]), Some(f64::INFINITY));
        assert_eq!(average_pnsr(&[]), None);
    }
}
