//! The scenes of a run: one a cell, or two where a job takes two bodies.

use crate::measure::{Experiment, MeasureError};
use serde::{Deserialize, Deserializer};

/// What joins the names of two scenes where a job takes two.
pub(in crate::measure) const PAIR: &str = " + ";

/// None, one or several: runs of earlier versions have none or one.
pub(super) fn one_or_many<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<String>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged, expecting = "expected a scene's name or a list of them")]
    enum Scenes {
        None(()),
        One(String),
        Many(Vec<String>),
    }
    Ok(match Scenes::deserialize(from)? {
        Scenes::None(()) => Vec::new(),
        Scenes::One(scene) => vec![scene],
        Scenes::Many(scenes) => scenes,
    })
}

/// The scenes of a run's cells: where the experiment's are pairs, those on the command line are joined two by two.
pub(super) fn of(experiment: &Experiment, given: &[String]) -> Result<Vec<String>, MeasureError> {
    if given.is_empty() {
        return Ok(experiment.scenes.clone());
    }
    if !experiment.scenes.iter().any(|scene| scene.contains(PAIR)) {
        return Ok(given.to_vec());
    }
    if given.iter().all(|scene| scene.contains(PAIR)) {
        return Ok(given.to_vec());
    }
    if !given.len().is_multiple_of(2) {
        return Err(MeasureError::Words(format!(
            "experiment {} tests two bodies against each other: give --scene twice, the one that moves first",
            experiment.name
        )));
    }
    Ok(given.chunks(2).map(|pair| pair.join(PAIR)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::{Known, Selection};

    fn experiment(scenes: &str) -> Experiment {
        let text = format!(
            "title = \"x\"\njob = \"collide\"\nscene = {scenes}\nframes = 1\nquick_frames = 1\nrepeats = 1\n\
             machines = [\"threads\"]\nprocessors = {{ threads = \"1\" }}\nschemes = [\"serial\"]\n"
        );
        Experiment::parse("x", "x.toml", &text, &Known::here()).unwrap()
    }

    #[test]
    fn two_bodies_are_given_two_by_two() {
        let (pairs, alone) = (experiment("\"robot + shell\""), experiment("[\"robot\", \"shell\"]"));
        let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
        assert_eq!(of(&pairs, &[]).unwrap(), words(&["robot + shell"]));
        assert_eq!(of(&pairs, &words(&["a", "b", "c", "d"])).unwrap(), words(&["a + b", "c + d"]));
        assert_eq!(of(&pairs, &words(&["a + b"])).unwrap(), words(&["a + b"]));
        let error = of(&pairs, &words(&["a"])).unwrap_err().to_string();
        assert!(error.contains("give --scene twice"), "{error}");
        assert_eq!(of(&alone, &words(&["a", "b"])).unwrap(), words(&["a", "b"]));
    }

    #[test]
    fn runs_of_earlier_versions_have_none_or_one() {
        for (text, expected) in [("null", vec![]), ("\"a\"", vec!["a"]), ("[\"a\", \"b\"]", vec!["a", "b"])] {
            let selection: Selection = serde_json::from_str(&format!("{{\"scene\": {text}}}")).unwrap();
            assert_eq!(selection.scenes, expected);
        }
    }
}
