//! `apportion advise`.

use super::words::AdviseWords;
use super::{print, tell};
use anyhow::Result;
use apportion::measure::advise::{Question, advise as ask};

/// Answers in three lines; with `--explain`, shows all that was tried.
pub(crate) fn advise(words: &AdviseWords) -> Result<()> {
    let question = Question {
        job: words.job.clone(),
        scene: words.scene.clone(),
        machine: words.machine.clone(),
        processors: words.processors,
    };
    let advice = ask(&question, &mut tell)?;
    print::line(&advice.to_string())?;
    if words.explain {
        print::line(&format!("\n{}", advice.ranking()))?;
    }
    Ok(())
}
