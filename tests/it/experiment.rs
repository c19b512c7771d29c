//! Experiment files: what is refused, and where.

use crate::mock;
use apportion::measure::Experiment;

/// The error of the mock experiment with one piece of its text replaced.
fn refused(from: &str, to: &str) -> String {
    let text = mock::EXPERIMENT.replacen(from, to, 1);
    assert_ne!(text, mock::EXPERIMENT, "`{from}` is not in it");
    let error =
        Experiment::parse("mock", "mock.toml", &text, &mock::known()).expect_err("it must be refused");
    error.to_string()
}

#[test]
fn errors_name_file_line_and_what_was_expected() {
    for (from, to, expected) in [
        ("frames = 20", "frames = ", "mock.toml, line 6: "),
        ("frames = 20", "frames = \"20\"", "mock.toml, line 6: invalid type: string \"20\", expected u32"),
        ("frames = 20", "frames = 0", "mock.toml, line 6: expected at least 1"),
        (
            "quick_frames",
            "fast_frames",
            "mock.toml, line 7: unknown field `fast_frames`, expected one of `title`",
        ),
        ("job = \"mock\"", "job = \"mok\"", "mock.toml, line 4: there is no job `mok`; near ones: mock"),
        (
            "\"stealing\"]",
            "\"steling\"]",
            "mock.toml, line 11: there is no scheme `steling`; near ones: stealing",
        ),
        (
            "\"stealing\"]",
            "\"rectangles\"]",
            "mock.toml, line 11: scheme `rectangles` is for work of another shape than job `mock` has; expected one of: serial, queue, ring, stealing",
        ),
        ("machines = [\"e4000\"", "machines = [\"e400\"", "mock.toml, line 9: there is no machine `e400`"),
        ("\"1-13\"", "\"1-13-4\"", "mock.toml, line 10: `1-13-4` is no list of processor counts"),
        ("\"*\" =", "\"x\" =", "mock.toml, line 9: `processors` says nothing of `threads`"),
        ("\"job.work\"", "\"work\"", "mock.toml, line 14: setting `work`: expected `job.`"),
        ("= 300", "= [300]", "mock.toml, line 14: expected an integer, a float, a boolean or a string"),
        ("= [1, 2]", "= []", "mock.toml, line 17: sweep of `ring.receivers`: expected at least one value"),
        ("value = 4.0", "value = \"4\"", "mock.toml, line 27: invalid type: string"),
        (
            "metric = \"speedup\"",
            "metric = \"spedup\"",
            "mock.toml, line 19: no metric `spedup` in `x` is declared",
        ),
        ("scheme = \"ring\"", "scheme = \"rings\"", "mock.toml, line 19: paper figure of `rings`"),
    ] {
        let error = refused(from, to);
        assert!(error.starts_with(expected), "{to}: {error}");
    }
}

#[test]
fn a_missing_key_is_named() {
    let error = refused("job = \"mock\"\n", "");
    assert!(error.contains("missing field `job`"), "{error}");
}
