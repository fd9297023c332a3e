//! Contacts with one sliding speed, such as two pads on a disc or the two feet of a box: they hold together what one contact with
//! the sum of their friction limits holds.

use stickslip::classification::{Evidence, Outcome};
use stickslip::model::OutputValue;

use super::outputs::outcomes;

/// Returns the outcomes of a block of 2 kg on a spring and a belt, with these contacts.
fn pads(belt_speed: &str, contacts: &[&str]) -> Vec<Outcome> {
    let contacts: Vec<String> =
        contacts.iter().enumerate().map(|(place, one)| format!("  pad_{place}: {one}\n")).collect();
    let system = format!(
        "parameters: {{m: 2 kg, k: 200 N/m, n: 20 N, v: {belt_speed}}}\n\
         coordinates: {{x: {{unit: m, start: [-0.1, 0.1], start_rate: [-0.5, 0.5]}}}}\n\
         mass: {{x: {{x: m}}}}\nforce: {{x: -k * x}}\ncontacts:\n{}",
        contacts.concat()
    );
    outcomes(&system, 24, 10.0)
}

/// Three pads with a third of the load each, or with other shares, move as one pad, at rest and in a limit cycle.
#[test]
fn pads_share_the_load() {
    pads_move_as_one("0.5 m/s");
    // Between both sums of friction limits, a pad that has slid stops, and one that rests stays.
    pads_move_as_one("0 m/s");
}

fn pads_move_as_one(stribeck_speed: &str) {
    let friction = format!(
        "{{stribeck: {{coefficient: 0.2, static_coefficient: 0.3, stribeck_speed: {stribeck_speed}}}}}"
    );
    let pad = |share: &str| format!("{{normal: {share}, sliding: x' - v, friction: {friction}}}");
    for (belt_speed, evidence) in
        [("0 m/s", Evidence::RestCertified), ("0.1 m/s", Evidence::ClosedOrbit)]
    {
        let one = pads(belt_speed, &[&pad("n")]);
        let three = pads(belt_speed, &[&pad("n / 2"), &pad("n / 3"), &pad("n / 6")]);
        for (one, three) in one.iter().zip(&three) {
            assert_eq!((one.evidence, three.evidence), (evidence, evidence), "{three:?}");
            let values = |outcome: &Outcome| {
                let output = outcome.outputs[0];
                let values = [OutputValue::End, OutputValue::Least, OutputValue::Greatest];
                let values = values.map(|value| output.value(value).expect("x does not drift"));
                let margin = outcome.friction_margin.unwrap_or_default();
                let [least, end, most] = values;
                [least, end, most, margin, outcome.period_s.unwrap_or_default()]
            };
            for (one, three) in values(one).into_iter().zip(values(three)) {
                assert!((one - three).abs() < 1e-7, "{one} {three}");
            }
        }
    }
}

/// A box on two feet comes to rest where its spring pulls with less than the friction of both feet, whatever each of them carries.
#[test]
fn a_box_rests_on_two_feet() {
    let foot = |side: &str, limit: &str| {
        format!(
            "  {side}: {{gap: \"y + h * (cos(phi) - 1) {} l * sin(phi)\", sliding: x' - h * phi', \
             friction: {{stribeck: {{coefficient: 0.4, static_coefficient: {limit}, \
             stribeck_speed: 0.01 m/s}}}}}}\n",
            if side == "left" { '-' } else { '+' }
        )
    };
    for limit in ["0.4", "0.6"] {
        let system = format!(
            "parameters: {{m: 2 kg, j: 0.05 kg m^2, h: 0.2 m, l: 0.3 m, k: 200 N/m, g: 9.81 m/s^2}}\n\
             coordinates:\n  x: {{unit: m, start: [-0.1, 0.1], start_rate: [-0.5, 0.5]}}\n  \
             y: {{unit: m}}\n  phi: {{unit: rad}}\n\
             mass: {{x: {{x: m}}, y: {{y: m}}, phi: {{phi: j}}}}\n\
             force: {{x: -k * x, y: -m * g}}\ncontacts:\n{}{}",
            foot("left", limit),
            foot("right", limit),
        );
        let limit: f64 = limit.parse().expect("a number");
        for outcome in outcomes(&system, 32, 10.0) {
            assert_eq!(outcome.evidence, Evidence::RestContracting, "{outcome:?}");
            let x = outcome.outputs[0].end;
            let margin = 1.0 - 200.0 * x.abs() / (limit * 2.0 * 9.81);
            let found = outcome.friction_margin.expect("contacts stick");
            assert!((found - margin).abs() < 1e-9, "{found} {margin} at {x}");
        }
    }
}
