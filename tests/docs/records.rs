//! Numbers in the documentation that take minutes to hours to compute: stored in `docs/records`, each with its study and
//! the version of the model, so that a stale record fails. `scripts/docs --records` recomputes them.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use stickslip::classification::MODEL_VERSION;
use stickslip::study::Study;

use super::generated::compare_or_write_part;
use crate::cli::support::{numbers, table, words};

/// The oldest version of the model with the rests of the present version, but for rounding. Records of it stay valid if they
/// depend on rests only, and are not the result of a search, which differences of rounding lead elsewhere. Version 8 differs
/// from version 7 in this: of 4096 runs of `studies/preferred-equilibria-contact.yaml`, the same 2697 come to rest, and 270
/// runs are shown to approach a limit cycle that were undecided; all outcomes of `studies/preferred-equilibria.yaml` agree to
/// the last bit, apart from the orbits of limit cycles, which differ by 1e-13.
const OLDEST_VERSION: u32 = 7;

/// Runs the program; `STICKSLIP` may name a release build.
fn stickslip(arguments: &[&str]) -> String {
    let program = std::env::var("STICKSLIP");
    let program = program.unwrap_or_else(|_| env!("CARGO_BIN_EXE_stickslip").to_owned());
    let output = Command::new(program)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(arguments)
        .output()
        .expect("the program starts");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {told}");
    String::from_utf8(output.stdout).expect("text")
}

/// Returns why a record of a study is stale, from what it says about itself; `None` if it is valid.
pub fn stale(of: &Value, study: &str) -> Option<String> {
    let due = about(study);
    let version = of["model_version"].as_u64().unwrap_or_default();
    let of_study = ["study", "resolved_study_sha256"].iter().all(|key| of[key] == due[key]);
    let valid =
        of_study && (u64::from(OLDEST_VERSION)..=u64::from(MODEL_VERSION)).contains(&version);
    (!valid).then(|| format!("the record is stale: it is of {of}, not of {due}"))
}

/// Returns what a record says about its study.
fn about(study: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(study);
    let resolved = Study::load(&path).expect("a study").resolved_yaml();
    let digest = Sha256::digest(resolved.as_bytes());
    json!({
        "study": study,
        "resolved_study_sha256": digest.iter().map(|byte| format!("{byte:02x}")).collect::<String>(),
        "model_version": MODEL_VERSION,
    })
}

/// Returns the values of a record; with `STICKSLIP_WRITE_RECORDS` set to 1, computes them in a
/// directory and stores them.
fn record(name: &str, study: &str, compute: impl FnOnce(&str) -> Value) -> Value {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = root.join("docs/records").join(name).with_extension("json");
    if std::env::var_os("STICKSLIP_WRITE_RECORDS").is_some_and(|value| value == "1") {
        let scratch = tempfile::tempdir().expect("a folder");
        let out = scratch.path().join("out");
        let values = compute(out.to_str().expect("a plain name"));
        let stored = json!({"of": about(study), "values": values});
        fs::create_dir_all(root.join("docs/records")).expect("a folder");
        fs::write(&file, format!("{stored:#}\n")).expect("written");
        return values;
    }
    let text = fs::read_to_string(&file).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut stored: Value = serde_json::from_str(&text).expect("JSON");
    if let Some(why) = stale(&stored["of"], study) {
        panic!("{name}: {why}; `scripts/docs --records`");
    }
    stored["values"].take()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number, not {value}"))
}

/// Formats an estimate with this number of decimals, such as `0.133 (0.130 to 0.136)`.
fn estimate(value: &Value, scale: f64, digits: usize) -> String {
    let [value, low, high] = ["value", "low", "high"].map(|key| scale * number(&value[key]));
    format!("{value:.digits$} ({low:.digits$} to {high:.digits$})")
}

/// Returns the result of the search for the best CD-ROM drive: `optimum.json`, and the mean
/// amplitudes relative to no balls at the three speeds.
fn cd_rom_values(out: &str) -> Value {
    let study = "studies/cd-rom.yaml";
    stickslip(&["optimize", study, "--out", out, "--quiet"]);
    let text = fs::read_to_string(Path::new(out).join("optimum.json")).expect("optimum.json");
    let optimum: Value = serde_json::from_str(&text).expect("JSON");
    let finals = table(&Path::new(out).join("finalists.parquet"));
    let (roles, relative) = (words(&finals, "role"), numbers(&finals, "relative"));
    let of = |role: &str| -> Vec<f64> {
        let rows = roles.iter().zip(&relative).filter(|(found, _)| found.as_deref() == Some(role));
        rows.filter_map(|(_, value)| *value).collect()
    };
    let relative = json!({"best": of("best"), "compare_with": of("compare_with")});
    json!({"optimum": optimum, "relative": relative})
}

/// The statements of docs/optimize.md about the CD-ROM drive agree with its search: the best unit
/// has almost no effect without imbalance, and the thesis's machine does harm.
#[test]
fn the_cd_rom_drive() {
    let values = record("cd-rom", "studies/cd-rom.yaml", cd_rom_values);
    let optimum = &values["optimum"];
    let (best, other) = (&optimum["best"], &optimum["compare_with"]);
    let described = |design: &Value| {
        let values = design["values"].as_object().expect("values");
        let each = values.iter().map(|(name, value)| match value {
            Value::String(choice) => format!("{name}: {choice}"),
            value => format!("{name}: {}", number(value)),
        });
        each.collect::<Vec<_>>().join("<br>")
    };
    let row = |title: &str, response: &str, scale: f64, digits: usize| {
        let of = |design: &Value| estimate(&design["responses"][response], scale, digits);
        format!("| {title} | {} | {} |\n", of(other), of(best))
    };
    assert_eq!(best["runs"], other["runs"]);
    let page = "docs/optimize.md";
    compare_or_write_part(
        page,
        "cd-rom",
        &format!(
            "\nThe search evaluates {} designs. Each of the two designs has {} final runs:\n\n\
             | | thesis's machine | best design |\n|---|---|---|\n{}{}| design | {} | {} |\n",
            optimum["search"]["designs"],
            best["runs"],
            row("95 % quantile, µm", "vibration_95", 1e6, 2),
            row("at rest by 2.5 s", "quiet", 1.0, 3),
            described(other),
            described(best),
        ),
    );
    let ratio = &optimum["best_over_compare_with"][0]["ratio"];
    compare_or_write_part(page, "cd-rom-ratio", &estimate(ratio, 1.0, 3));
    let relative = |role: &str| -> [f64; 2] {
        let all: Vec<f64> =
            values["relative"][role].as_array().expect("a list").iter().map(number).collect();
        let ends = |f: fn(f64, f64) -> f64, start| all.iter().copied().fold(start, f);
        [ends(f64::min, f64::INFINITY), ends(f64::max, f64::NEG_INFINITY)]
    };
    let (of_best, of_other) = (relative("best"), relative("compare_with"));
    assert!(of_best[0] > 0.9 && of_best[1] < 1.1 && of_other[0] > 1.3, "{of_best:?} {of_other:?}");
    let range = |[low, high]: [f64; 2]| format!("{low:.2} to {high:.2}");
    compare_or_write_part(page, "cd-rom-relative", &range(of_best));
    compare_or_write_part(page, "cd-rom-relative-thesis", &range(of_other));
    // The two largest first-order indices of each response.
    let largest = |response: &str| {
        let all = optimum["sensitivities"].as_array().expect("a list");
        let mut indices: Vec<(f64, &str)> = all
            .iter()
            .filter(|index| index["response"] == response)
            .map(|index| {
                (
                    number(&index["first_order"]["value"]),
                    index["variable"].as_str().expect("a name"),
                )
            })
            .collect();
        indices.sort_by(|index, other| other.0.total_cmp(&index.0));
        let each = indices.iter().take(2).map(|(index, name)| format!("`{name}` {index:.2}"));
        each.collect::<Vec<_>>().join(" and ")
    };
    compare_or_write_part(page, "cd-rom-indices", &largest("vibration_95"));
    compare_or_write_part(page, "cd-rom-indices-rest", &largest("quiet"));
}

/// The rate at which irregular motion comes to rest, from 400 runs of 300 s, is that of
/// docs/methods.md, beside that of the thesis's study.
#[test]
fn the_escape_rate() {
    let values = record("escape-rate", "studies/escape-rate.yaml", |out| {
        stickslip(&["run", "studies/escape-rate.yaml", "--out", out, "--quiet"]);
        escape_rate(&table(&Path::new(out).join("points.parquet")), 0)
    });
    compare_or_write_part("docs/methods.md", "escape-rate", &rate_in_words(&values));
}

pub fn escape_rate(points: &arrow::array::RecordBatch, point: usize) -> Value {
    let of = |name: &str| numbers(points, name)[point];
    json!({
        "value": of("escape_rate_per_s"),
        "low": of("escape_rate_low_per_s"),
        "high": of("escape_rate_high_per_s"),
        "from_s": of("escape_from_s"),
    })
}

/// Formats a rate, such as `0.0029/s (0.0025 to 0.0034)`.
pub fn rate_in_words(rate: &Value) -> String {
    estimate(rate, 1.0, 4).replacen(" (", "/s (", 1)
}

/// The variables of a start, and how the page names them.
const START_VARIABLES: [(&str, &str, usize); 7] = [
    ("ramp_over_1_s", "first ramp, s", 2),
    ("ramp_to_1_rad_s", "to, rad/s", 1),
    ("hold_1_s", "plateau, s", 2),
    ("ramp_over_2_s", "second ramp, s", 2),
    ("ramp_to_2_rad_s", "to, rad/s", 1),
    ("hold_2_s", "plateau, s", 2),
    ("ramp_over_3_s", "last ramp, s", 2),
];

/// The responses of a start, how the page names them, their scale and their decimals.
const START_RESPONSES: [(&str, &str, f64, usize); 4] = [
    ("vibration_95", "95 % quantile of the residual amplitude, µm", 1e6, 1),
    ("relative", "mean amplitude over that without balls", 1.0, 2),
    ("peak_95", "95 % quantile of the peak amplitude, µm", 1e6, 0),
    ("quiet", "probability of rest within 5 s", 1.0, 3),
];

/// Returns the result of the search for the best start of the disc: its final designs, the ratio of the best one to the
/// plain ramp, and the ranges of the responses over all designs.
fn start_values(out: &str) -> Value {
    stickslip(&["optimize", "studies/startup-profile.yaml", "--out", out, "--quiet"]);
    let file = |name: &str| Path::new(out).join(name);
    let text = fs::read_to_string(file("optimum.json")).expect("optimum.json");
    let optimum: Value = serde_json::from_str(&text).expect("JSON");
    let (all, finals) = (table(&file("evaluations.parquet")), table(&file("finalists.parquet")));
    let range = |response: &str| {
        let known: Vec<f64> = numbers(&all, response).into_iter().flatten().collect();
        let end = |f: fn(f64, f64) -> f64| known.iter().copied().reduce(f);
        json!([end(f64::min), end(f64::max)])
    };
    let roles = words(&finals, "role");
    let finalist = |row: usize| {
        let mut values = json!({"role": roles[row]});
        for (name, ..) in START_VARIABLES {
            values[name] = json!(numbers(&finals, name)[row]);
        }
        for (name, ..) in START_RESPONSES {
            let of = |suffix: &str| numbers(&finals, &format!("{name}{suffix}"))[row];
            values[name] = json!({"value": of(""), "low": of("_low"), "high": of("_high")});
        }
        values
    };
    json!({
        "designs": all.num_rows(),
        "ratio": optimum["best_over_compare_with"][0]["ratio"],
        "final_runs": optimum["best"]["runs"],
        "finalists": (0..roles.len()).map(finalist).collect::<Vec<Value>>(),
        "vibration_95": range("vibration_95"),
    })
}

/// The tables of docs/startup.md are those of the search: the best start has less than a third of the quantile of the plain
/// ramp, and brings nearly all balls to rest, which the plain ramp does not.
#[test]
fn the_start_of_the_disc() {
    let values = record("startup-profile", "studies/startup-profile.yaml", start_values);
    let finalists = values["finalists"].as_array().expect("a list");
    let of_role =
        |role: &str| finalists.iter().find(|design| design["role"] == role).expect("a design");
    let (plain, best) = (of_role("compare_with"), of_role("best"));
    let at_rest = |design: &&Value| number(&design["quiet"]["value"]);
    let calmest =
        finalists.iter().max_by(|design, other| at_rest(design).total_cmp(&at_rest(other)));
    let designs = [plain, best, calmest.expect("a design")];
    assert!(number(&best["quiet"]["low"]) > 0.9 && number(&plain["quiet"]["high"]) < 0.1);
    assert!(number(&values["ratio"]["high"]) < 1.0 / 3.0);
    let row = |title: &str, cell: &dyn Fn(&Value) -> String| {
        format!("| {title} | {} |\n", designs.map(cell).join(" | "))
    };
    let responses = START_RESPONSES.iter().map(|(name, title, scale, digits)| {
        row(title, &|design| estimate(&design[*name], *scale, *digits))
    });
    let variables = START_VARIABLES.iter().map(|(name, title, digits)| {
        row(title, &|design| format!("{:.digits$}", number(&design[*name])))
    });
    let rows: String = responses.chain(variables).collect();
    let page = "docs/startup.md";
    let text = format!(
        "\nThe search evaluates {} designs. Each of these designs has {} final runs:\n\n\
         | | plain ramp | lowest quantile | most often at rest |\n|---|---|---|---|\n{rows}\n",
        values["designs"], values["final_runs"],
    );
    compare_or_write_part(page, "startup", &text);
    compare_or_write_part(page, "startup-ratio", &estimate(&values["ratio"], 1.0, 3));
    let [low, high] = [0, 1].map(|end| 1e6 * number(&values["vibration_95"][end]));
    compare_or_write_part(page, "startup-all", &format!("{low:.0} to {high:.0}"));
}
