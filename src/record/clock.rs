//! The calendar: times in UTC as RFC 3339 writes them.

use std::time::{SystemTime, UNIX_EPOCH};

/// Now, as `2026-03-01T12:00:00Z`.
pub fn utc_now() -> String {
    let [year, month, day, hour, minute, second] = civil(seconds_since_1970());
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

/// Today, as `2026-03-01`.
pub(crate) fn today() -> String {
    utc_now()[..10].to_owned()
}

/// A run's id: now, as `20260301T120000Z`, so that folders sort by age.
pub fn run_id() -> String {
    utc_now().replace(['-', ':'], "")
}

fn seconds_since_1970() -> u64 {
    // A clock before 1970 is a clock that was never set; the epoch is as good a guess as any.
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

/// Year, month, day, hour, minute and second. Counts in eras of 400 years (146,097 days) from 1 March of year 0, so
/// that the leap day is the last of its year (Hinnant, "chrono-compatible low-level date algorithms").
fn civil(seconds: u64) -> [u64; 6] {
    let days = seconds / 86_400 + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted + 2) / 5 + 1;
    let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    let rest = seconds % 86_400;
    [year, month, day, rest / 3_600, rest / 60 % 60, rest % 60]
}

#[cfg(test)]
mod tests {
    use super::civil;

    #[test]
    fn knows_leap_days_and_year_ends() {
        assert_eq!(civil(0), [1970, 1, 1, 0, 0, 0]);
        assert_eq!(civil(951_782_399), [2000, 2, 28, 23, 59, 59]);
        assert_eq!(civil(951_782_400), [2000, 2, 29, 0, 0, 0]);
        assert_eq!(civil(1_709_210_096), [2024, 2, 29, 12, 34, 56]);
        assert_eq!(civil(1_767_225_599), [2025, 12, 31, 23, 59, 59]);
        assert_eq!(civil(4_107_542_400), [2100, 3, 1, 0, 0, 0]);
    }
}
