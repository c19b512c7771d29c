//! Rows, their columns, the log they are written to.
