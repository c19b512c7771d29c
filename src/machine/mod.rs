//! What code runs on.
