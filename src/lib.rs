//! `apportion` shares graphics work out over processors and shows what that buys.
//!
//! The rooms, and the arrows allowed between them (a test holds them):
//!
//! ```text
//! scene -> structure -> job -> measure -> record -> report      what is done, and what comes of it
//! machine <- sync <- scheme <- job                              what it runs on, and how it is shared out
//! ```

pub mod geometry;
pub mod job;
pub mod machine;
pub mod measure;
pub mod record;
pub mod report;
pub mod scene;
pub mod scheme;
pub mod structure;
pub mod sync;
