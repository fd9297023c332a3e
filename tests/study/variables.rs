//! Variables of designs: a design has the cases of a sweep over the same values.

use stickslip::study::{DesignValue, json_schema};

use super::{laws, parse, study};

#[test]
fn every_numeric_parameter_can_be_a_variable() {
    let schema = json_schema();
    let mut names = schema["properties"]["uncertain"]["properties"].as_object().unwrap().clone();
    // Keys without units are tested in units.rs.
    names.retain(|_, distribution| !distribution.to_string().contains("WithUnits"));
    let (mut tried, mut refused) = (0, 0);
    for (kind, speed) in
        [("ball_balancer", "rad_s"), ("block_on_spring", "m_s"), ("block_on_belt", "m_s")]
    {
        for friction in laws(speed) {
            let plain = format!(
                "schema: 1\nname: a\nseed: 1\nmodel: {{kind: {kind}, friction: {friction}}}\n\
                 initial_conditions: {{design: {{monte_carlo: {{samples: 4}}}}}}\n"
            );
            let base = study(&plain);
            for name in names.keys() {
                // A factor of 1 draws the nominal value.
                let nominal = format!(
                    "{plain}uncertain: {{{name}: {{times: {{choice: {{values: [1]}}}}}}}}\n"
                );
                let nominal = parse(&nominal).map(|study| study.planned_run(0).uncertain[0]);
                let number = match &nominal {
                    Err(error) if error.problem().starts_with("not a parameter of") => continue,
                    Err(_) => 1.0,
                    Ok(number) => *number,
                };
                let other = if number == 0.0 { 0.1 } else { 1.25 * number };
                let (from, to) = (number.min(other), number.max(other));
                let design = format!("{plain}design: {{{name}: {{from: {from}, to: {to}}}}}\n");
                if nominal.is_err() {
                    let error = parse(&design).unwrap_err();
                    assert!(error.problem().contains("does not use it"), "{error}");
                    refused += 1;
                    continue;
                }
                let set = study(&design).set(&[DesignValue::Number(other)]).unwrap();
                let swept = study(&format!("{plain}sweep: [{{grid: {{{name}: [{other}]}}}}]\n"));
                for run in 0..4 {
                    let [set, swept] = [&set, &swept].map(|study| study.planned_run(run));
                    let place = format!("{name} of {kind}, {friction}, run {run}");
                    assert_eq!((&set.case, &set.start), (&swept.case, &swept.start), "{place}");
                    assert_ne!(set.case, base.planned_run(run).case, "{place}");
                }
                tried += 1;
            }
        }
    }
    // A balancer with two balls has 22 parameters and the blocks have 4 and 5; the friction laws
    // add 0, 2, 1, 1 and 1. Viscous friction does not use three parameters of the balls and one of
    // each block.
    assert_eq!((tried, refused), (5 * (22 + 4 + 5) + 3 * 5 - 5, 5));
}
