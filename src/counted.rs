//! Numbers of things in sentences.

use std::fmt::Display;

/// Returns a number of things, such as `1 run` or `2 runs`.
pub(crate) fn counted<N: Display + From<u8> + PartialEq>(count: N, thing: &str) -> String {
    let ending = if count == N::from(1) { "" } else { "s" };
    format!("{count} {thing}{ending}")
}
