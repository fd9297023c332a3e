//! Numbers of things in sentences.

use std::fmt::Display;

/// Returns a number of things, such as `1 run` or `2 runs`.
pub(crate) fn counted<N: Display + From<u8> + PartialEq>(count: N, thing: &str) -> String {
    let ending = if count == N::from(1) { "" } else { "s" };
    format!("{count} {thing}{ending}")
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn one_thing_and_several() {
        let all = [0_u64, 1, 2].map(|count| counted(count, "run"));
        assert_eq!(all, ["0 runs", "1 run", "2 runs"]);
    }
}
