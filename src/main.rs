//! The command `apportion`: see `apportion help`.

mod command;

use std::process::ExitCode;

fn main() -> ExitCode {
    command::main()
}
