//! `apportion stress`: invariants under load on real threads.

use super::print;
use anyhow::Result;
use apportion::measure::{MeasureError, stress};
use std::fmt::Write;
use std::time::Duration;

/// Stresses a scheme or primitive, prints what was done, and fails if an invariant broke.
pub(crate) fn stress(what: &str, processors: u32, seconds: u64) -> Result<()> {
    let report = stress::stress(what, processors as usize, Duration::from_secs(seconds), |_| {});
    let report = report.map_err(|error| match error {
        stress::StressError::Unknown { .. } => MeasureError::Words(error.to_string()),
        broken => MeasureError::Failed(broken.to_string()),
    })?;
    if report.violations.is_empty() {
        let (runs, nodes) = (report.runs, report.nodes);
        return print::line(&format!(
            "{what}: {runs} runs, {nodes} nodes, turns, boxes or rays, every invariant held"
        ));
    }
    let mut text = format!("an invariant broke after {} runs", report.runs);
    for violation in &report.violations {
        write!(text, "\n{} with seed {}: {}", violation.what, violation.seed, violation.found)?;
    }
    Err(MeasureError::Failed(text).into())
}
