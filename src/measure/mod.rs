//! Runs one cell of a sweep and turns it into rows.

pub mod stress;
