//! The value of a setting.

use serde::Deserialize;
use std::fmt;

/// A setting's value, as an experiment's file gives it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "expected an integer, a float, a boolean or a string")]
pub enum Value {
    /// `300`
    Integer(i64),
    /// `0.5`
    Float(f64),
    /// `true`
    Flag(bool),
    /// `"padded"`
    Text(String),
}

impl fmt::Display for Value {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(value) => write!(out, "{value}"),
            // Debug keeps the point of 2.0, so that a float stays a float for who reads the rows.
            Self::Float(value) => write!(out, "{value:?}"),
            Self::Flag(value) => write!(out, "{value}"),
            Self::Text(value) => write!(out, "{value}"),
        }
    }
}

impl Value {
    /// The number, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Integer(value) => Some(*value as f64),
            Self::Float(value) => Some(*value),
            Self::Flag(_) | Self::Text(_) => None,
        }
    }
}
