//! One binary for all integration tests: oracles, goldens in virtual time, invariants, command line, house rules.

mod advise;
mod build;
mod collide;
mod command_line;
mod compare;
mod cull_moving;
mod draw;
mod experiment;
mod house_rules;
mod loaders;
mod memory;
mod mock;
mod page;
mod record;
mod render;
mod report;
mod run;
mod scene;
mod schemes;
mod structure;
mod tiles;
mod trace;
mod trace_file;
mod virtual_time;
