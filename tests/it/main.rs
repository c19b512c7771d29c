//! One binary for all integration tests: oracles, goldens in virtual time, invariants, command line, house rules.

mod scene;
mod schemes;
mod structure;
