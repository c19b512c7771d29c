//! Several rays that go the same way.
