//! Whether colours can be told apart, by whom, on which ground.

use super::{COLOURS, Look, NAMED};
use std::collections::BTreeSet;

const GROUNDS: [&str; 2] = ["#ffffff", "#15171b"];
/// What a full-colour eye sees, and a protan, deutan and tritan one (Machado, Oliveira and Fernandes 2009), in linear
/// light.
const EYES: [[[f64; 3]; 3]; 4] = [
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
];

fn linear(colour: &str) -> [f64; 3] {
    [1, 3, 5].map(|at| {
        let part = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap()) / 255.0;
        if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
    })
}

/// The contrast of WCAG 2.
fn contrast(a: &str, b: &str) -> f64 {
    let light = |colour| linear(colour).iter().zip([0.2126, 0.7152, 0.0722]).map(|(a, b)| a * b).sum::<f64>();
    let (a, b): (f64, f64) = (light(a), light(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

fn times(matrix: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|line| line.iter().zip(v).map(|(a, b)| a * b).sum())
}

/// A place in OKLab (Ottosson 2020), where distances are what eyes see.
fn lab(linear: [f64; 3]) -> [f64; 3] {
    let cones = [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ];
    let sides = [
        [0.2104542553, 0.793617785, -0.0040720468],
        [1.9779984951, -2.428592205, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.808675766],
    ];
    times(sides, times(cones, linear.map(|part| part.clamp(0.0, 1.0))).map(f64::cbrt))
}

#[test]
fn colours_are_told_apart_by_every_eye_on_both_grounds() {
    for ground in 0..2 {
        for (number, pair) in COLOURS.iter().enumerate() {
            let seen = contrast(pair[ground], GROUNDS[ground]);
            assert!(seen >= 3.0, "{} on {}: {seen:.2}", pair[ground], GROUNDS[ground]);
            for other in &COLOURS[..number] {
                for eye in EYES {
                    let [a, b] = [pair[ground], other[ground]].map(|colour| lab(times(eye, linear(colour))));
                    let apart = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
                    assert!(apart > 0.1, "{} and {}: {apart:.3}", pair[ground], other[ground]);
                }
            }
        }
    }
}

#[test]
fn a_look_belongs_to_a_name() {
    let looks: BTreeSet<Look> = NAMED.iter().map(|(name, ..)| Look::of(name, 0)).collect();
    assert_eq!(looks.len(), NAMED.len(), "two schemes look the same");
    let settings: BTreeSet<Look> = (0..24).map(|variant| Look::of("hybrid", variant)).collect();
    assert_eq!(settings.len(), 24, "two settings look the same");
    assert!(settings.iter().all(|look| look.colour == Look::of("hybrid", 0).colour));
    assert_eq!(Look::of("of tomorrow", 0), Look::of("of tomorrow", 0));
}
