//! `meta.json`: what was run, by which version, where, when.

use super::{RecordError, write_whole};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::process::Command;

/// All that a run's rows do not say about it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Meta {
    /// The run's id.
    pub run: String,
    /// The experiment's name.
    pub experiment: String,
    /// The command line, word by word.
    pub command: Vec<String>,
    /// The version of this package.
    pub version: String,
    /// The commit it was built from, with `-dirty` where files differed; none where git cannot tell.
    pub commit: Option<String>,
    /// The computer.
    pub host: Host,
    /// The seed all randomness of the run comes from.
    pub seed: u64,
    /// When it began, UTC.
    pub start: String,
    /// When its last cell was done, UTC; none while cells are missing.
    pub end: Option<String>,
    /// What the run was narrowed to on the command line, kept so that a resumed run asks the same question.
    pub selection: serde_json::Value,
}

/// The computer a run was made on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Host {
    /// The processor's name; `unknown` where the system does not tell.
    pub cpu: String,
    /// Hardware threads this process may use.
    pub cores: u32,
    /// The processor's clock as the run began, MHz; none where the system does not tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock_mhz: Option<u32>,
    /// Main memory, bytes; none where the system does not tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory: Option<u64>,
    /// Caches of the first core: `L1 Data 32K`; empty where the system does not tell.
    pub caches: Vec<String>,
    /// Operating system and instruction set: `linux x86_64`.
    pub system: String,
}

impl Host {
    /// The computer in a line: processor, cores, clock, memory, system.
    pub fn line(&self) -> String {
        let cores = if self.cores == 1 { "1 core".to_owned() } else { format!("{} cores", self.cores) };
        let clock = self.clock_mhz.map_or(String::new(), |clock| format!(" at {clock} MHz"));
        let memory = self.memory.map_or(String::new(), |bytes| {
            format!(", {:.1} GiB of memory", bytes as f64 / f64::from(1 << 30))
        });
        format!("{}, {cores}{clock}{memory}, {}", self.cpu, self.system)
    }

    /// The computer this runs on.
    pub fn here() -> Self {
        Self {
            cpu: told("/proc/cpuinfo", "model name").unwrap_or_else(|| "unknown".to_owned()),
            cores: std::thread::available_parallelism().map_or(1, |cores| cores.get() as u32),
            clock_mhz: told("/proc/cpuinfo", "cpu MHz")
                .and_then(|clock| Some(clock.parse::<f64>().ok()? as u32)),
            memory: told("/proc/meminfo", "MemTotal").and_then(|memory| kibibytes(&memory)),
            caches: caches(),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        }
    }
}

impl Meta {
    /// Reads `meta.json`.
    ///
    /// # Errors
    /// It cannot be read, or holds something else.
    pub fn read(path: &Path) -> Result<Self, RecordError> {
        let bytes = std::fs::read(path).map_err(RecordError::file("read", path))?;
        serde_json::from_slice(&bytes).map_err(|error| RecordError::Line {
            path: path.to_path_buf(),
            line: error.line(),
            message: error.to_string(),
        })
    }

    /// Writes `meta.json`, whole.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), RecordError> {
        write_whole(path, |out| {
            serde_json::to_writer_pretty(&mut *out, self)?;
            writeln!(out)
        })
    }

    /// The commit this program was built from: asked of the repository the program lies in, not of the folder the
    /// user happens to stand in, which may be another project's.
    pub fn commit_here() -> Option<String> {
        let program = std::env::current_exe().ok()?;
        let output = Command::new("git")
            .arg("-C")
            .arg(program.parent()?)
            .args(["describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"])
            .output()
            .ok()
            .filter(|output| output.status.success())?;
        Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
    }
}

/// What stands behind the first such word and its colon in a file of the system's.
fn told(file: &str, word: &str) -> Option<String> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find(|line| line.starts_with(word))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// Bytes of so many `kB`, as the system calls them.
fn kibibytes(text: &str) -> Option<u64> {
    text.strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

fn caches() -> Vec<String> {
    let index = |number: u32| {
        let read = |word: &str| {
            let path = format!("/sys/devices/system/cpu/cpu0/cache/index{number}/{word}");
            std::fs::read_to_string(path).ok().map(|text| text.trim().to_owned())
        };
        Some(format!("L{} {} {}", read("level")?, read("type")?, read("size")?))
    };
    (0..).map_while(index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_computer_is_told_in_a_line_as_far_as_it_is_known() {
        let mut host = Host {
            cpu: "A".into(),
            cores: 1,
            clock_mhz: None,
            memory: None,
            caches: vec![],
            system: "s".into(),
        };
        assert_eq!(host.line(), "A, 1 core, s");
        (host.cores, host.clock_mhz, host.memory) = (2, Some(333), kibibytes("131072 kB"));
        assert_eq!(host.line(), "A, 2 cores at 333 MHz, 0.1 GiB of memory, s");
        assert_eq!((kibibytes("12"), kibibytes("x kB")), (None, None));
        // What was written before there were clock and memory is read still.
        let old: Host = serde_json::from_str(r#"{"cpu":"A","cores":1,"caches":[],"system":"s"}"#).unwrap();
        assert_eq!((old.clock_mhz, old.memory), (None, None));
    }
}
