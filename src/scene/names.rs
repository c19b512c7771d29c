//! Advice on names that are not known.

/// What to say about an unknown `name`: the near ones among `known`, or all of them if none is near.
pub(super) fn advice<'a>(name: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    let wanted = name.to_lowercase();
    let near = |other: &&str| {
        edit_distance(&wanted, other) <= 1 + other.chars().count() / 6
            || (wanted.len() >= 3 && other.contains(&wanted))
    };
    let listed: Vec<&str> = known.clone().filter(near).collect();
    if listed.is_empty() {
        format!("known are {}", known.collect::<Vec<_>>().join(", "))
    } else {
        format!("did you mean {}?", listed.join(" or "))
    }
}

/// How many letters must be put in, taken out or changed to make one word the other (Levenshtein).
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, other) in b.iter().enumerate() {
            let changed = diagonal + usize::from(letter != *other);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_and_advice() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "abc"), 3);
        let known = ["factory-large", "factory-small"];
        assert_eq!(advice("factory-lage", known.into_iter()), "did you mean factory-large?");
        assert_eq!(advice("zebra", known.into_iter()), "known are factory-large, factory-small");
    }
}
