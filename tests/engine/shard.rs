//! Shards: every run is in exactly one of them.

use stickslip::engine::Shard;

#[test]
fn shards_have_every_run_once() {
    for parts in [1_u64, 2, 3, 7, 12] {
        for all in [0, 1, 5, 12, 100] {
            let mut ids: Vec<u64> = (1..=parts)
                .flat_map(|part| {
                    let shard: Shard = format!("{part}/{parts}").parse().unwrap();
                    (0..shard.fraction(all)).map(move |index| shard.number(index))
                })
                .collect();
            ids.sort_unstable();
            assert_eq!(ids, (0..all).collect::<Vec<_>>(), "{parts} parts of {all}");
        }
    }
}

#[test]
fn shards_that_do_not_exist() {
    for wrong in ["3/2", "0/2", "1/0", "2", "a/b", "", "1/2/3", "-1/2", "1.5/2"] {
        let error = wrong.parse::<Shard>().unwrap_err().to_string();
        assert!(error.contains(&format!("{wrong:?}")) && error.contains("1 ≤ K ≤ N"), "{error}");
    }
}
