//! The contact between balls in a study file, and start states in which balls do not overlap.

use std::fmt::Display;

use stickslip::model::BallContact;
use stickslip::study::Study;

use super::{parse, study};
use crate::support::{assert_has, rows};

/// Returns the text of a study of balls with this contact, design and box.
fn text(contact: &str, balls: usize, design: &str, start_box: &str) -> String {
    format!(
        "schema: 1\nname: a\nseed: 5\nmodel:\n  kind: ball_balancer\n  parameters: {{balls: {balls}}}\n  \
         contact: {contact}\ninitial_conditions:\n  box: {start_box}\n  design: {design}\n"
    )
}

fn contact(study: &Study) -> Option<BallContact> {
    study.model().ball_balancer().expect("balls").contact
}

/// Checks the parts of the message about a study.
#[track_caller]
fn refused(text: &str, parts: &[impl Display]) {
    assert_has(&parse(text).expect_err(text).to_string(), parts);
}

const CONTACT: &str = "{restitution: 0.5, friction_coefficient: 0.2}";
const STRATIFIED: &str = "{stratified: {parts_per_axis: 2, samples_per_cell: 1}}";

/// The contact is a law or none, and the same in the resolved study.
#[test]
fn the_contact_is_a_law_or_none() {
    let of = |key: &str| {
        let first = study(&text(key, 2, STRATIFIED, "{}"));
        let again = study(&first.resolved_yaml());
        assert_eq!(first.resolved_yaml(), again.resolved_yaml());
        assert_eq!(contact(&first), contact(&again), "{key}");
        contact(&first)
    };
    assert_eq!(of("none"), None);
    let law = |restitution, friction_coefficient| BallContact { restitution, friction_coefficient };
    assert_eq!(of(CONTACT), Some(law(0.5, 0.2)));
    assert_eq!(of("{}"), Some(law(0.36, 0.1)));
    assert_eq!(
        of("{material_restitution: 0.9}"),
        Some(law(2.5 / 7.0, 0.1)).map(|law| BallContact { restitution: (0.9 - 0.4) / 1.4, ..law })
    );
    assert_eq!(of("{material_restitution: 0.2}"), Some(law(0.0, 0.1)));
}

#[test]
fn both_numbers_are_swept_and_drawn() {
    let swept = text(CONTACT, 2, STRATIFIED, "{}")
        + "sweep:\n  - grid: {contact_restitution: [0.1, 0.9]}\n\
           uncertain:\n  contact_friction_coefficient: {uniform: {min: 0.1, max: 0.3}}\n";
    let study = study(&swept);
    for (point, restitution) in [(0, 0.1), (1, 0.9)] {
        let model = study.point(point).model().clone();
        let found = model.ball_balancer().and_then(|machine| machine.contact).expect("contact");
        assert_eq!(found, BallContact { restitution, friction_coefficient: 0.2 });
    }
    let case = study.planned_run(0).case.expect("sound");
    let drawn = case.model.ball_balancer().and_then(|machine| machine.contact).expect("contact");
    assert!((0.1..0.3).contains(&drawn.friction_coefficient) && drawn.friction_coefficient != 0.2);
    // The value itself is not among the parameters.
    let given = text(CONTACT, 2, STRATIFIED, "{}")
        .replace("parameters: {", "parameters: {contact_restitution: 0.5, ");
    let parameter = "`model.parameters.contact_restitution`";
    refused(&given, &[parameter, "not a key of `parameters`", "the key `model.contact`"]);
    // Without contact there are no such parameters.
    refused(&swept.replace(CONTACT, "none"), &["contact_restitution"]);
}

#[test]
fn wrong_contacts_are_refused_with_their_key() {
    for row in rows(
        "{restitution: 1.2} ¦ a.yaml:7 ¦ model.contact.restitution ¦ 1.2 ¦ a number from 0 to 1
{material_restitution: -1} ¦ model.contact.material_restitution ¦ -1
{restitution: 0.3, material_restitution: 0.9} ¦ model.contact.material_restitution ¦ one of both
{friction_coefficient: -0.1} ¦ model.contact.friction_coefficient ¦ at least 0
steel ¦ model.contact ¦ none
{restitutoin: 0.3} ¦ restitutoin ¦ restitution",
    ) {
        refused(&text(&row[0], 2, STRATIFIED, "{}"), &row[1..]);
    }
    let viscous = text(CONTACT, 2, STRATIFIED, "{}").replace(
        "  contact:",
        "  friction: {viscous: {viscous_coefficient_n_s_m: 1.0e-4}}\n  contact:",
    );
    refused(&viscous, &["model.contact.friction_coefficient"]);
    let block = "schema: 1\nname: a\nseed: 5\nmodel:\n  kind: block_on_spring\n  contact: none\n\
                 initial_conditions:\n  design: {monte_carlo: {samples: 1}}\n";
    refused(block, &["model.contact", "ball_balancer"]);
}

/// Returns the smallest gap of a planned run.
fn least_gap(study: &Study, run: u64) -> f64 {
    let planned = study.planned_run(run);
    let case = planned.case.expect("sound");
    let machine = case.model.ball_balancer().expect("balls");
    let mut balls: Vec<usize> = (0..machine.balls.len()).collect();
    let angle = |ball: usize| planned.start.0[2 + ball].rem_euclid(std::f64::consts::TAU);
    balls.sort_by(|ball, other| angle(*ball).total_cmp(&angle(*other)));
    let gap = |place: usize| {
        let (behind, ahead) = (balls[place], balls[(place + 1) % balls.len()]);
        let touching = machine.contact_angle_rad(&machine.balls[behind], &machine.balls[ahead]);
        (angle(ahead) - angle(behind)).rem_euclid(std::f64::consts::TAU) - touching
    };
    (0..balls.len()).map(gap).fold(f64::INFINITY, f64::min)
}

/// Sampled balls do not overlap; ball 1 and everything but the angles is as without contact, in every design.
#[test]
fn sampled_balls_do_not_overlap() {
    for design in [
        STRATIFIED,
        "{latin_hypercube: {samples: 200}}",
        "{sobol: {samples: 256}}",
        "{monte_carlo: {samples: 200}}",
    ] {
        for balls in [2, 3, 8] {
            let design = if balls == 8 { "{monte_carlo: {samples: 200}}" } else { design };
            let [with, without] =
                [CONTACT, "none"].map(|key| study(&text(key, balls, design, "{}")));
            for run in 0..with.run_count().min(200) {
                assert!(least_gap(&with, run) >= -1e-12, "{design}, {balls} balls, run {run}");
                let (mapped, drawn) =
                    (with.planned_run(run).start.0, without.planned_run(run).start.0);
                let kept = [0, 1, 2].into_iter().chain(2 + balls..mapped.len());
                kept.for_each(|place| assert_eq!(mapped[place], drawn[place]));
            }
        }
    }
}

#[test]
fn angles_of_a_small_box_are_drawn_again_in_their_cell() {
    let small = "{beta: [1.0, 1.8]}";
    let study = study(&text(CONTACT, 2, STRATIFIED, small));
    let mut near = 0;
    for run in 0..study.run_count() {
        assert!(least_gap(&study, run) >= 0.0, "run {run}");
        let angles = &study.planned_run(run).start.0[2..4];
        assert!(angles.iter().all(|angle| (1.0..=1.8).contains(angle)));
        near += i32::from(least_gap(&study, run) < 0.05);
    }
    assert!(near > 0);
    // Both balls always overlap in a box of the width of a quarter of a ball.
    let narrow = super::study(&text(CONTACT, 2, STRATIFIED, "{beta: [1.0, 1.06]}"));
    let error = narrow.planned_run(0).case.expect_err("no room").to_string();
    assert!(error.contains("room for the balls"), "{error}");
}

#[test]
fn given_balls_that_overlap_are_refused() {
    let table = "{table: {columns: [x, y, beta_1, beta_2, x_dot, y_dot, beta_dot_1, beta_dot_2], \
                 rows: [[0, 0, 1, 2, 0, 0, 0, 0], [0, 0, 1, 1.1, 0, 0, 0, 0]]}}";
    let parts = ["rows[1]", "balls overlap", "balls 1 and 2", "0.26"];
    refused(&text(CONTACT, 2, table, "{}"), &parts);
    assert!(parse(&text("none", 2, table, "{}")).is_ok());
}
