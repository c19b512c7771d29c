use proptest::prelude::*;

use super::*;

fn number(text: &str) -> Result<f32, String> {
    Words::new(text.as_bytes()).number().map_err(|fault| fault.0.found)
}

#[test]
fn comments_and_braces_end_words() {
    let mut words = Words::new(b"\xef\xbb\xbf x a{# \xe9\n}b%c\r\n\x0c1.5#d\n-2%e");
    for expected in ["x", "a", "{", "}", "b%c"] {
        assert_eq!(words.peek(), Some(expected.as_bytes()));
        assert_eq!(words.next(), Some(expected.as_bytes()));
    }
    assert_eq!((words.number().unwrap(), words.number().unwrap()), (1.5, -2.0));
    assert_eq!((words.next(), words.peek()), (None, None));
    assert_eq!(words.wrong("more").0.found, "the file ends");
}

#[test]
fn places_are_counted_from_one() {
    let text = b"ab\n\n cd\nx";
    let mut words = Words::new(text);
    let expected = [(1, 1), (1, 2), (1, 3), (2, 1), (3, 1), (3, 2), (3, 3), (3, 4), (4, 1), (4, 2)];
    for (at, place) in expected.into_iter().enumerate() {
        assert_eq!(words.place(at), place, "{at}");
    }
    assert_eq!(words.place(1), (1, 2), "also backwards");
}

#[test]
fn what_is_no_number_is_refused() {
    let wrong =
        ["", "-", ".", "+.", "e5", "1e", "1e+", "nan", "inf", "-inf", "0x10", "1,5", "1_0", "--1", "1.5.2"];
    for text in wrong.into_iter().chain(["1e39", "-1e99999999999", "٣", "1f", "{"]) {
        assert!(number(text).is_err(), "{text}");
    }
    for text in ["-1", "1.0", "4294967296", "99999999999999999999", "", "x", "1x"] {
        assert!(Words::new(text.as_bytes()).whole().is_err(), "{text}");
    }
    assert_eq!(Words::new(b"0004294967295 ").whole().unwrap(), u32::MAX);
}

#[test]
fn numbers_on_the_edge_are_rounded_once() {
    let middles =
        ["16777217", "16777219", "1.000000059604644775390625", "1.0000000596046448", "33554434.0000001"];
    let small = ["1e-45", "7e-46", "1.1754943e-38", "1.17549429e-38", "-0", "0.0", "5.14416e-18", "0e99999"];
    let long =
        ["0.1000000000000000055511151231257827", "123456789012345678901234567890", "00000000000000000000001"];
    let wide = ["3.4028235e38", "1.5e22", "1.5e23", ".5", "5.", "+7", "1E+3", "9007199254740993", "1e-400"];
    for text in middles.into_iter().chain(small).chain(long).chain(wide) {
        let expected: f32 = text.parse().unwrap();
        assert_eq!(number(text).unwrap().to_bits(), expected.to_bits(), "{text}");
        let found = Words::new(text.as_bytes()).double().unwrap();
        assert_eq!(found.to_bits(), text.parse::<f64>().unwrap().to_bits(), "{text}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn numbers_are_those_of_the_standard_library(
        text in "[-+]?[0-9]{0,12}(\\.[0-9]{0,12})?([eE][-+]?[0-9]{1,2})?|[-+]?0\\.[0-9]{1,9}|[-+.eE0-9]{1,9}",
    ) {
        let expected = text.parse::<f32>().ok().filter(|number| number.is_finite());
        prop_assert_eq!(number(&text).ok().map(f32::to_bits), expected.map(f32::to_bits));
    }

    #[test]
    fn every_f32_comes_back(bits in any::<u32>()) {
        let value = f32::from_bits(bits);
        prop_assume!(value.is_finite());
        prop_assert_eq!(number(&value.to_string()).unwrap().to_bits(), bits);
        prop_assert_eq!(number(&format!("{value:e}")).unwrap().to_bits(), bits);
    }
}
