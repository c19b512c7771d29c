//! How work is shared out, by the shape of the work.
