//! Studies of systems in files: their runs are as reproducible as those of built-in models, and commands speak of them by
//! their names.

use std::path::Path;

use super::support::{Scratch, counts, numbers, words};
use crate::support::TwoBlocks;

const STUDIES: [(&str, &str, &str); 3] = [
    ("woodpecker", "woodpecker", "samples: 16"),
    ("block-chain", "block_chain", "samples: 8"),
    ("run-up", "unbalanced_shaft", "samples: 8"),
];

/// Returns a folder with the studies and their systems, with four runs at each point.
fn studies() -> Scratch {
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.path("systems")).expect("a folder");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
    for (study, system, samples) in STUDIES {
        let text = std::fs::read_to_string(shipped.join(format!("{study}.yaml"))).expect("a study");
        assert!(text.contains(samples), "{study}");
        scratch.write(&format!("{study}.yaml"), text.replace(samples, "samples: 4"));
        let file = format!("systems/{system}.yaml");
        let text = std::fs::read_to_string(shipped.join(&file)).expect("a system");
        scratch.write(&file, text);
    }
    scratch
}

/// Threads, an interruption and shards change no byte, and a replay gives its row.
#[test]
fn runs_of_systems_in_files_are_reproducible() {
    let scratch = studies();
    for (name, _, _) in STUDIES {
        scratch.well(&format!("run {name}.yaml --out {name} --threads 1"));
        let data = scratch.data(name);
        scratch.well(&format!("run {name}.yaml --out {name}-2 --threads 2 --chunk 3"));
        assert_eq!(scratch.data(&format!("{name}-2")), data, "{name}");

        let stopped = format!("{name}-stopped");
        scratch.ended(&format!("run {name}.yaml --out {stopped} --max-seconds 0"), 130);
        // The results contain the system: its file is not needed any more.
        std::fs::rename(scratch.path("systems"), scratch.path("away")).expect("it moves");
        scratch.well(&format!("resume {stopped}"));
        assert_eq!(scratch.data(&stopped), data, "{name}");
        let report = scratch.json(&format!("replay {name} 1 --out {name}-replay --json"));
        assert_eq!(report["same_as_row"], true, "{name}");
        std::fs::rename(scratch.path("away"), scratch.path("systems")).expect("it moves back");

        for shard in [1, 2] {
            scratch.well(&format!("run {name}.yaml --shard {shard}/2 --out {name}-s{shard}"));
        }
        scratch.well(&format!("merge {name}-s1 {name}-s2 --out {name}-merged"));
        assert_eq!(scratch.data(&format!("{name}-merged")), data, "{name}");
        scratch.well(&format!("report {name}"));
    }
}

/// Tables name coordinates and contacts as the file does, with their units.
#[test]
fn columns_have_the_names_of_the_file() {
    let scratch = studies();
    scratch.well("run woodpecker.yaml --out a");
    let rows = scratch.table("a", "runs");
    assert!(words(&rows, "label").iter().all(|label| label.as_deref() == Some("limit_cycle")));
    let least = numbers(&rows, "min_phi_bird_rad");
    let most = numbers(&rows, "max_phi_bird_rad");
    assert!(least.iter().zip(&most).all(|(least, most)| least < most), "{least:?} {most:?}");
    for column in [
        "initial_y_m",
        "initial_phi_bird_rate_rad_s",
        "end_phi_sleeve_rad",
        "mean_y_rate_m_s",
        "mean_torque_nm",
    ] {
        assert_eq!(numbers(&rows, column).iter().flatten().count(), 4, "{column}");
    }
    assert_eq!(numbers(&rows, "mean_y_m"), [None; 4], "it falls");
    // The lower edge of the sleeve sticks while the bird swings; the beak only hits the pole.
    let sticks = |contact: &str| numbers(&rows, &format!("stick_fraction_{contact}"));
    assert!(sticks("lower").iter().all(|part| part.is_some_and(|part| (0.2..0.4).contains(&part))));
    assert_eq!(sticks("beak"), [Some(0.0); 4]);
    scratch.well("replay a 0 --out b");
    let motion = scratch.table("b", "trajectory");
    let normal = numbers(&motion, "normal_lower_n");
    assert!(normal.iter().flatten().any(|force| *force > 0.0));
    for column in ["sliding_speed_upper_m_s", "phi_bird_rad", "torque_nm"] {
        assert!(motion.column_by_name(column).is_some(), "{column}");
    }
}

/// Responses measure outputs, by the name of the output or of a column.
#[test]
fn responses_measure_outputs() {
    let scratch = studies();
    let text = scratch.text("woodpecker.yaml");
    let with = |of: &str| {
        format!(
            "{text}\nresponses:\n  most: {{amplitude_worst: {{of: {of}}}}}\n  half: {{amplitude_mean: {{of: phi_bird_rad}}}}\n"
        )
    };
    scratch.write("woodpecker.yaml", with("max_torque_nm"));
    scratch.well("run woodpecker.yaml --out a");
    let (rows, points) = (scratch.table("a", "runs"), scratch.table("a", "points"));
    let column = |name: &str| numbers(&rows, name).into_iter().flatten().collect::<Vec<f64>>();
    let most = column("max_torque_nm").into_iter().fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(numbers(&points, "response_most"), [Some(most)]);
    let [low, high] = ["min_phi_bird_rad", "max_phi_bird_rad"].map(column);
    let half = low.iter().zip(&high).map(|(low, high)| 0.5 * (high - low)).sum::<f64>() / 4.0;
    let found = numbers(&points, "response_half")[0].expect("a mean");
    assert!((found - half).abs() < 1e-12 * half, "{found} {half}");
    scratch.write("woodpecker.yaml", with("max_torque"));
    scratch
        .refused("check woodpecker.yaml", &["not a quantity of a run", "max_torque", "torque_nm"]);
}

/// `check` prints the equations as they were read.
#[test]
fn check_prints_the_equations() {
    let scratch = studies();
    scratch.prints(
        "check woodpecker.yaml",
        &[
            "woodpecker with 3 contacts, coulomb friction",
            "system (woodpecker)",
            "mass y, phi_bird",
            "m_bird * l_bird",
            "-(m_bird + m_sleeve) * g",
            "restitution: 0.5",
            "certified where all contacts stick and cannot break loose again",
            "natural frequency 458",
        ],
    );
}

/// Results of other equations are never taken for those of a study.
#[test]
fn changed_equations_are_noticed() {
    let scratch = studies();
    scratch.well("run block-chain.yaml --out a");
    let file = "systems/block_chain.yaml";
    let text = scratch.text(file);
    scratch.write(
        file,
        text.replace("-leaf_stiffness * x[block]", "-1.5 * leaf_stiffness * x[block]"),
    );
    scratch.refused("run block-chain.yaml --out a", &["a"]);
    scratch.well("run block-chain.yaml --out b");
    assert_ne!(scratch.data("a"), scratch.data("b"));
    // A comment changes no equation.
    scratch.write(file, format!("# Changed.\n{text}"));
    scratch.well("run block-chain.yaml --out a");
}

/// A system file lies with its study, and a missing one is said.
#[test]
fn places_of_system_files_are_limited() {
    let scratch = studies();
    let text = scratch.text("block-chain.yaml");
    scratch.write("systems/cut.yaml", "system: a\nforce: {x: sum(block, x[block])}\n");
    scratch.write("systems/empty.yaml", "");
    for (study, file) in [
        ("missing", "systems/chain.yaml"),
        ("outside", "../block_chain.yaml"),
        ("number", "3"),
        ("cut", "systems/cut.yaml"),
        ("empty", "systems/empty.yaml"),
    ] {
        let text = text.replace("systems/block_chain.yaml", file);
        scratch.write(&format!("{study}.yaml"), text);
    }
    scratch.refuses(
        "check",
        "missing.yaml ¦ missing.yaml: ¦ `model.system` ¦ systems/chain.yaml
outside.yaml ¦ the system file lies outside
number.yaml ¦ not a system ¦ the name of a system file
cut.yaml ¦ systems/cut.yaml:2: ¦ needs quotation marks
empty.yaml ¦ systems/empty.yaml ¦ the file is empty",
    );
}

/// Positions, speeds and switches of two blocks that stick and slip are those of the closed form.
#[test]
fn two_blocks_move_as_in_closed_form() {
    let scratch = studies();
    for (number, (method, coupling, belt_speed, tolerance)) in
        [("event", 0.5, 0.1, 1e-10), ("event", 1.7, 0.25, 1e-10), ("switch", 0.5, 0.1, 1e-6)]
            .into_iter()
            .enumerate()
    {
        // With 1 kg, 100 N/m and 10 N: the units of the closed form are 0.1 m, 0.1 s and 1 m/s. The band is 1e-8 m/s.
        let text = format!(
            "schema: 1\nname: a\nseed: 1\nmodel:\n  system: systems/block_chain.yaml\n  \
             parameters: {{coupling_stiffness_n_m: {}, belt_speed_m_s: {belt_speed}}}\n\
             initial_conditions:\n  box: {{x_1_m: [0.012, 0.012], x_2_m: [-0.03, -0.03], \
             x_rate_1_m_s: [0.3, 0.3], x_rate_2_m_s: [-0.1, -0.1]}}\n  \
             design: {{monte_carlo: {{samples: 1}}}}\n\
             simulation: {{end_time_s: 6, method: {method}, band: 5.0e-9, \
             tolerance: {{relative: 1.0e-11, absolute: 1.0e-12}}}}\n",
            100.0 * coupling
        );
        scratch.write("a.yaml", text);
        let out = format!("out-{number}");
        scratch.well(&format!("run a.yaml --out {out}"));
        scratch.well(&format!("replay {out} 0 --times 0:5.9:591 --out {out}-replay"));
        let table = scratch.table(&format!("{out}-replay"), "switches");
        let units = |all: Vec<Option<f64>>, unit: f64| {
            all.into_iter().map(|value| value.map(|value| value / unit)).collect::<Vec<_>>()
        };
        let all =
            (words(&table, "to"), units(numbers(&table, "time_s"), 0.1), counts(&table, "contact"));
        // In the band of the switch model, a block passes through a transition on its way.
        let is_end = |to: &Option<String>| !to.as_deref().unwrap_or("").starts_with("transition");
        let mut switches = (0..table.num_rows()).filter(|&row| is_end(&all.0[row])).peekable();
        let trajectory = scratch.table(&format!("{out}-replay"), "trajectory");
        let times = units(numbers(&trajectory, "time_s"), 0.1);
        let of = |before: &str, after: &str, unit: f64| {
            [1, 2]
                .map(|block| units(numbers(&trajectory, &format!("{before}{block}{after}")), unit))
        };
        let (positions, speeds) = (of("x_", "_m", 0.1), of("sliding_speed_belt_", "_m_s", 1.0));

        let mut exact = TwoBlocks {
            coupling,
            belt_speed,
            kinetic_coefficient: 0.1,
            static_coefficient: 0.2,
            since: 0.0,
            x: [0.12, -0.3],
            u: [0.3, -0.1],
            phases: [(0.3 - belt_speed).signum(), -1.0],
        };
        let (mut sticks, mut slips) = (0, 0);
        for (row, time) in times.iter().map(|time| time.expect("a time")).enumerate() {
            while let Some(block) = exact.next_switch(time) {
                let row = switches.next().expect("a switch");
                let (to, at) = (all.0[row].as_deref(), all.1[row].expect("a time"));
                let phase = match exact.phases[block] {
                    0.0 => "stick",
                    1.0 => "slip_forward",
                    _ => "slip_backward",
                };
                assert_eq!((to, all.2[row]), (Some(phase), block as u64 + 1), "{method} at {at}");
                assert!((at - exact.since).abs() < tolerance, "{at}: {}", at - exact.since);
                if phase == "stick" { sticks += 1 } else { slips += 1 }
            }
            let (x, u) = exact.at(time - exact.since);
            for block in 0..2 {
                let [position, speed] =
                    [&positions, &speeds].map(|of| of[block][row].expect("a number"));
                let errors = [position - x[block], speed + belt_speed - u[block]];
                let most = errors[0].abs().max(errors[1].abs());
                assert!(most < tolerance, "{method}, block {block} at {time}: {errors:?}");
            }
        }
        assert!(sticks > 5 && slips > 5, "{sticks} sticks, {slips} slips");
    }
}
