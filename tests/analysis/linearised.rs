//! Linearised.
