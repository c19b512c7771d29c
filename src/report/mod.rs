//! Tables and charts, drawn from rows only.
