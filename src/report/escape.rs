//! Words made safe between tags and in quotes.

/// A word as the text of an element or the value of a quoted attribute, in HTML and XML alike.
pub(crate) fn attribute(word: &str) -> String {
    let mut safe = String::with_capacity(word.len());
    for letter in word.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            // XML holds no other control letters, however they are written.
            '\t' | '\n' => safe.push(letter),
            letter if letter.is_control() => safe.push('\u{fffd}'),
            letter => safe.push(letter),
        }
    }
    safe
}

/// A word as an anchor: what needs no quoting anywhere.
pub(crate) fn anchor(word: &str) -> String {
    let fits = |letter: char| letter.is_ascii_alphanumeric() || "-_.".contains(letter);
    word.chars().map(|letter| if fits(letter) { letter } else { '-' }).collect()
}

/// A relative path as a link.
pub(crate) fn link(path: &str) -> String {
    let mut link = String::new();
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"-_.~/".contains(&byte) {
            link.push(char::from(byte));
        } else {
            link.push_str(&format!("%{byte:02X}"));
        }
    }
    link
}

#[cfg(test)]
mod tests {
    use super::{anchor, attribute, link};

    #[test]
    fn nothing_gets_out_of_its_quotes() {
        assert_eq!(
            attribute("<b a=\"1\" b='2'>&\u{1}"),
            "&lt;b a=&quot;1&quot; b=&#39;2&#39;&gt;&amp;\u{fffd}"
        );
        assert_eq!(anchor("cull-large <x>"), "cull-large--x-");
        assert_eq!(link("../a b/\"#?.csv"), "../a%20b/%22%23%3F.csv");
    }
}
