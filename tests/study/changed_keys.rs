//! The keys in which two studies differ.

use stickslip::study::{Study, changed_keys};

use super::parse;

fn study(change: impl Fn(String) -> String) -> Study {
    let text = "schema: 1\nname: one\nseed: 7\nmodel: {kind: ball_balancer}\n\
                sweep: [{grid: {speed_rad_s: [-160.0, -200.0]}}]\n\
                initial_conditions: {design: {monte_carlo: {samples: 4}}}\n";
    parse(&change(text.to_owned())).unwrap()
}

#[test]
fn what_differs_is_named_with_both_values() {
    let before = study(|text| text);
    assert!(changed_keys(&before, &study(|text| format!("# a comment\n{text}"))).is_empty());
    let changed = |from: &'static str, to: &'static str| {
        let after = study(|text| {
            assert!(text.contains(from));
            text.replace(from, to)
        });
        changed_keys(&before, &after)
    };
    assert_eq!(changed("seed: 7", "seed: 8"), ["seed: 7 -> 8"]);
    assert_eq!(
        changed("-200.0]", "-200.0, -240.0]"),
        ["sweep[0].grid.speed_rad_s: [-160.0,-200.0] -> [-160.0,-200.0,-240.0]"]
    );
    let other_friction = changed(
        "kind: ball_balancer",
        "kind: ball_balancer, friction: {viscous: {viscous_coefficient_n_s_m: 1.0e-4}}",
    );
    assert!(
        other_friction.iter().any(|line| line.starts_with("model.friction")),
        "{other_friction:?}"
    );
    assert_eq!(
        changed("monte_carlo: {samples: 4}", "sobol: {samples: 4}"),
        [
            "initial_conditions.design.monte_carlo: {\"samples\":4} -> not given",
            "initial_conditions.design.sobol: not given -> {\"samples\":4}"
        ]
    );
}
