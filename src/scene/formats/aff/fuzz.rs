//! Damaged files are refused, with their file and place named, or read; they never panic, hang or take memory that
//! their size does not account for.

use std::path::Path;

use proptest::prelude::*;

use super::super::load;
use super::parse::parse;

const OWN: &str = "v from 0 0 9 at 0 0 0 up 0 1 0 angle 40 hither 1 resolution 4 3 b 0 0.5 1 am 1 1 1 d 1\n\
    l 1 2 3 .5 .5 .5 la arm 0 0 1 a 0 2.5 7 # c\n\
    i 0 part.aff xs 1 2 3 0 0 1 90 4 5 6 { i 1 part.aff x arm { s 1 1 1 -1 i 0 part.aff } }\n\
    f 1 0 0 .5 .5 9 0 1 p 5 0 0 0 4 0 0 4 4 0 2 1 0 0 4 0\n\
    k arm { transl 4 0 0 0 0 0 0 0 1 1 0 0 0 0 0 2 2 0 0 0 0 0 3 3 0 0 0 0 0 visibility 1 0 1 }\n";
const PART: &str = "m vertices 3 0 0 0 1 0 0 0 1 0 normals 1 0 0 1 texturecoords 2 t.ppm 0 0 1 1\n\
    triangles 1 0 1 2 0 0 0 0 1 1 fm 1 1 1 0 1 0 0 0 1 30 0.9 1.5 c 0 0 0 1 0 0 2 0.5\n\
    tpa 2 0 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1 1 0 0 1 0 0 1 1 0 1 0 0 1 0 1 1 0 0 1\n\
    ttp t.ppm 0 0 0 0 0 1 0 0 1 0 0 0 0 1 1 1 0 1 0 0 0 1 1 0 k arm { rot 4 0 0 0 1 0 0 0 0 1 0 0 1 90 0 0 0\n\
    2 0 0 1 180 0 0 0 3 0 0 1 0 0 0 0 }";

/// Whether a scene of these two files is accepted.
fn accepts(folder: &Path, own: &[u8], part: &[u8]) -> bool {
    let path = folder.join("own.aff");
    std::fs::write(&path, own).unwrap();
    std::fs::write(folder.join("part.aff"), part).unwrap();
    match load(&path) {
        Ok(scene) => {
            scene.validate().unwrap();
            true
        }
        Err(error) => {
            let said = error.to_string();
            assert!(said.contains("own.aff: ") || said.contains("part.aff: "), "{said}");
            assert!(said.contains("; expected "), "{said}");
            false
        }
    }
}

#[test]
fn what_is_cut_anywhere_is_refused_or_ends_between_statements() {
    let folder = tempfile::tempdir().unwrap();
    assert!(accepts(folder.path(), OWN.as_bytes(), PART.as_bytes()));
    let count = |text: &str| {
        let cut = |end: &usize| parse("own.aff", "own", &text.as_bytes()[..*end]).is_ok();
        (0..text.len()).filter(cut).count()
    };
    // At most a few bytes of each statement: blanks, and digits that a number can do without.
    assert!((10..OWN.len() / 4).contains(&count(OWN)), "{}", count(OWN));
    assert!((10..PART.len() / 3).contains(&count(PART)), "{}", count(PART));
}

#[test]
fn every_byte_may_be_any_other() {
    for text in [OWN, PART] {
        for at in 0..text.len() {
            for byte in *b"\0 {}#\n9-.eaix\xff" {
                let mut bytes = text.as_bytes().to_vec();
                bytes[at] = byte;
                if let Err(error) = parse("own.aff", "own", &bytes) {
                    let said = error.to_string();
                    assert!(said.starts_with("own.aff: line ") && said.contains("; expected "), "{said}");
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whole words in other places, which gets deeper than bytes do.
    #[test]
    fn words_may_be_exchanged_repeated_and_lost(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..4u8), 1..5),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let [own, part] = [OWN, PART].map(|text| {
            let mut words: Vec<&str> = text.split_inclusive([' ', '\n']).collect();
            for (from, to, how) in &changes {
                let (from, to) = (from.index(words.len()), to.index(words.len()));
                match how {
                    0 => words.swap(from, to),
                    1 => words[to] = words[from],
                    2 => words.insert(to, words[from]),
                    _ => drop(words.remove(from)),
                }
            }
            words.concat()
        });
        accepts(folder.path(), own.as_bytes(), PART.as_bytes());
        accepts(folder.path(), OWN.as_bytes(), part.as_bytes());
        accepts(folder.path(), own.as_bytes(), part.as_bytes());
    }

    #[test]
    fn any_bytes_may_come(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse("own.aff", "own", &bytes);
    }
}
