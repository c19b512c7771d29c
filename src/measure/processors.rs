//! Lists of processor counts: `1,2,4-13`, `cores`, `1-cores`.

/// More than this many OS threads help nobody and may exhaust the system.
const MOST_THREADS: u32 = 256;
/// More than this many virtual processors no preset was made for.
const MOST_SIMULATED: u32 = 4_096;

/// Reads a list of processor counts; `cores` stands for the hardware threads there are.
///
/// # Errors
/// In words: what stands there and what was expected. Counts go from 1 to 4,096, on real threads to 256.
pub fn processor_list(text: &str, cores: u32, simulated: bool) -> Result<Vec<u32>, String> {
    let most = if simulated { MOST_SIMULATED } else { MOST_THREADS };
    let count = |word: &str| -> Result<u32, String> {
        let count = match word.trim() {
            "cores" => cores,
            word => word.parse().map_err(|_| {
                format!(
                    "`{text}` is no list of processor counts: expected a list like `1,2,4-13` or `1-cores`"
                )
            })?,
        };
        if (1..=most).contains(&count) {
            return Ok(count);
        }
        let machine = if simulated { "a simulated machine" } else { "real threads" };
        Err(format!("{count} processors: {machine} can have from 1 to {most}"))
    };
    let mut counts = Vec::new();
    for part in text.split(',') {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let (first, last) = (count(first)?, count(last)?);
        if first > last {
            return Err(format!("`{part}` counts down: expected the smaller number first"));
        }
        counts.extend(first..=last);
    }
    counts.sort_unstable();
    counts.dedup();
    Ok(counts)
}

#[cfg(test)]
mod tests {
    use super::processor_list;

    #[test]
    fn reads_lists_ranges_and_cores() {
        assert_eq!(processor_list("4-6, 1,2", 8, true), Ok(vec![1, 2, 4, 5, 6]));
        assert_eq!(processor_list("1-cores", 3, false), Ok(vec![1, 2, 3]));
        assert_eq!(processor_list("cores", 3, false), Ok(vec![3]));
        assert_eq!(processor_list("1024", 2, true), Ok(vec![1024]));
    }

    #[test]
    fn refuses_what_is_no_count() {
        for (text, simulated) in [
            ("0", true),
            ("10000", true),
            ("257", false),
            ("", true),
            ("a", true),
            ("3-1", true),
            ("1-", true),
        ] {
            assert!(processor_list(text, 2, simulated).is_err(), "{text}");
        }
        assert!(processor_list("0-3", 2, true).unwrap_err().contains("from 1 to 4096"));
    }
}
