//! What the user may have meant.

/// Names at most this far off are offered; a third of the name's letters where that is more.
const NEAR: usize = 2;

/// The names near to a wrong one, as the end of an error: `; near ones: a, b`, or all there are where none is near.
pub fn near<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let all: Vec<&str> = names.into_iter().collect();
    if all.is_empty() {
        return "; there are none".to_owned();
    }
    let limit = NEAR.max(name.chars().count() / 3);
    let mut ranked: Vec<(usize, &str)> = all.iter().map(|other| (distance(name, other), *other)).collect();
    ranked.retain(|(off, other)| *off <= limit || (name.len() > 2 && other.contains(name)));
    ranked.sort();
    if ranked.is_empty() {
        return format!("; there are: {}", all.join(", "));
    }
    let words: Vec<&str> = ranked.into_iter().map(|(_, other)| other).collect();
    format!("; near ones: {}", words.join(", "))
}

/// How many letters must be put in, taken out or changed (Levenshtein), row by row of the usual table.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.chars().enumerate() {
        let mut corner = i;
        row[0] = i + 1;
        for (j, other) in b.iter().enumerate() {
            let changed = corner + usize::from(letter != *other);
            corner = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(corner + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::{distance, near};

    #[test]
    fn offers_the_near_ones_first() {
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "abc"), 3);
        let names = ["cull-large", "cull-small", "tree-work"];
        assert_eq!(near("cul-large", names), "; near ones: cull-large");
        assert_eq!(near("cull", names), "; near ones: cull-large, cull-small");
        assert_eq!(near("xyz", names), "; there are: cull-large, cull-small, tree-work");
    }
}
