//! `stickslip report`: the page agrees with the tables, and incomplete or damaged input is refused.

use std::fs;

use serde_json::Value;

use super::summary::{REST, finished, kill, rewrite, study, without};
use super::support::{AT_ONCE, Scratch, assert_has, counts, words};

/// Returns the data of the page's script.
fn data(page: &str) -> Value {
    let (_, rest) = page.split_once("<script type=\"application/json\" id=\"data\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

fn figure<'a>(data: &'a Value, id: &str) -> &'a Value {
    data["figures"].as_array().unwrap().iter().find(|figure| figure["id"] == id).unwrap()
}

/// Returns the numbers of the runs behind the dots of a panel's layer.
fn run_ids(panel: &Value, layer: &str) -> Vec<u64> {
    let layers = panel["layers"].as_array().unwrap();
    let named = layers.iter().filter(|of| of["name"] == layer && of["mark"] == "dots");
    named.flat_map(|layer| whole(&layer["tooltips"]["run_ids"])).collect()
}

/// Returns integers, packed or not.
fn whole(packed: &Value) -> Vec<u64> {
    use base64::Engine;
    let Some(text) = packed["u"].as_str() else {
        return packed.as_array().unwrap().iter().map(|id| id.as_u64().unwrap()).collect();
    };
    let bytes = base64::engine::general_purpose::STANDARD.decode(text).unwrap();
    bytes.chunks(4).map(|four| u64::from(u32::from_le_bytes(four.try_into().unwrap()))).collect()
}

#[test]
fn dots_are_the_runs_of_the_tables() {
    let rest = "sweep: [{grid: {speed_rad_s: [-160.0, -216.3772]}}]\n";
    let scratch = Scratch::ran(study(60, 8.0, rest));
    let before = scratch.files();
    assert_eq!(scratch.well("report out"), "out-report.html\n");
    let text = scratch.text("out-report.html");
    assert!(text.len() < 5_000_000);
    let data = data(&text);
    assert_eq!(data["directory"], "out");
    let runs = scratch.table("out", "runs");
    let (ids, points) = (counts(&runs, "run_id"), counts(&runs, "point_id"));
    let labels = words(&runs, "label");
    let of = |point: u64, label: &str| -> Vec<u64> {
        let each = ids.iter().zip(&points).zip(&labels);
        let chosen = each.filter(|((_, p), l)| **p == point && l.as_deref() == Some(label));
        chosen.map(|((id, _), _)| *id).collect()
    };
    let preferred = figure(&data, "preferred-equilibria")["panels"].as_array().unwrap();
    assert_eq!(preferred.len(), 2);
    for (point, panel) in (0..).zip(preferred) {
        let at_rest = of(point, "equilibrium");
        assert_eq!(run_ids(panel, "equilibrium"), at_rest);
        let said = format!("{} of 60 at rest", at_rest.len());
        assert!(panel["title"].as_str().unwrap().ends_with(&said), "{}", panel["title"]);
    }
    // Every run is in each plane of start states, under its label.
    let basins = figure(&data, "basins")["panels"].as_array().unwrap();
    assert_eq!(basins.len(), 2 * 6);
    for (place, panel) in basins.iter().enumerate() {
        for label in ["equilibrium", "limit cycle", "irregular", "undecided", "failed"] {
            let expected = of(place as u64 / 6, &label.replace(' ', "_"));
            assert_eq!(run_ids(panel, label), expected, "{label}");
        }
    }
    // The page is a function of the directory, which is not changed.
    assert_eq!(scratch.well("report out --out again/b.html"), "again/b.html\n");
    assert_eq!(scratch.text("again/b.html"), text);
    scratch.well("run a.yaml --out one --threads 1");
    scratch.well("report one --out out2.html");
    let other = self::data(&scratch.text("out2.html"));
    assert_eq!(other["figures"], data["figures"]);
    let after = scratch.files();
    assert!(before.iter().all(|(name, content)| after.get(name) == Some(content)));
}

#[test]
fn failures_and_flips_are_in_plain_sight() {
    let (scratch, _) = finished();
    scratch.well("report out");
    let text = scratch.text("out-report.html");
    let runs = scratch.table("out", "runs");
    let labels = words(&runs, "label");
    let failed = labels.iter().filter(|label| label.as_deref() == Some("failed")).count();
    assert_has(&text, &[format!("<strong>Some runs failed:</strong> {failed} of 60")]);
    let audited = words(&runs, "audit_label");
    let flips =
        labels.iter().zip(&audited).filter(|(label, other)| other.is_some() && label != other);
    let notable = failed + flips.filter(|(label, _)| label.as_deref() != Some("failed")).count();
    assert_eq!(text.matches("<code>stickslip replay out ").count(), notable);
    // Text of the study and of errors is escaped in the page.
    assert!(!text.contains("<script>alert"));
    // Figures report the failed runs that they cannot show, and label results that are not sampled.
    let failed = counts(&scratch.table("out", "points"), "failed_runs")[0];
    assert!(failed > 0);
    assert_has(&text, &[format!("Failed runs are not shown: {failed} of 20 at speed")]);
    assert_has(&text, &["is the median over the runs; each run has its own ball mass."]);
    let data = data(&text);
    let curve =
        figure(&data, "time-to-rest")["panels"][0]["layers"][0]["name"].as_str().expect("a name");
    assert!(curve.ends_with(&format!("({failed} failed)")), "{curve}");
}

#[test]
fn all_kinds_of_studies_have_a_page() {
    let balls = "model: {kind: ball_balancer, parameters: {balls: N}}\n";
    // It sticks and slips, because friction drops when it slides.
    let belt = "model: {kind: block_on_belt, friction: {stribeck: {static_friction_coefficient: 0.2, \
                stribeck_speed_m_s: 0}}}\n";
    for (model, figures) in [
        (balls.replace('N', "1"), ["preferred-equilibria", "basins"]),
        (balls.replace('N', "4"), ["preferred-equilibria", "basins"]),
        ("model: {kind: block_on_spring}\n".to_owned(), ["preferred-equilibria", "time-to-rest"]),
        (belt.to_owned(), ["limit-cycles", "exceedance"]),
    ] {
        let scratch = Scratch::ran(study(30, 20.0, &model));
        scratch.well("report out");
        let data = data(&scratch.text("out-report.html"));
        for id in figures {
            let ids: Vec<&Value> =
                data["figures"].as_array().unwrap().iter().map(|f| &f["id"]).collect();
            assert!(ids.contains(&&id.into()), "{model} {id}: {ids:?}");
        }
    }
}

/// Each value of a third parameter has its own map, and curves have values instead of long names.
#[test]
fn further_parameters_have_maps_of_their_own() {
    let rest = "sweep: [{grid: {speed_rad_s: [-160.0, -200.0, -220.0], \
                friction_coefficient: [1.0e-5, 1.0e-4, 1.0e-2], normal_force: [lagrange, newton]}}]\n";
    let scratch = Scratch::ran(study(4, AT_ONCE, rest));
    scratch.well("report out");
    let data = data(&scratch.text("out-report.html"));
    let panels = figure(&data, "map")["panels"].as_array().unwrap();
    for force in ["lagrange", "newton"] {
        let title = format!("normal force {force}");
        let of_force: Vec<&Value> =
            panels.iter().filter(|panel| panel["title"] == *title).collect();
        assert!(!of_force.is_empty(), "{title}");
        for panel in of_force {
            assert_eq!(panel["layers"][0]["values"].as_array().unwrap().len(), 9);
            let [x, y] = [&panel["x"], &panel["y"]];
            assert_eq!(
                [&x["name"], &x["unit"], &y["name"]],
                ["speed", "rad/s", "friction coefficient"]
            );
            // Over three decades.
            assert_eq!(panel["y"]["kind"], "logarithmic");
        }
    }
    let curves = &figure(&data, "time-to-rest")["panels"][0]["layers"][0]["name"];
    assert_eq!(curves, "\u{2212}160, 1e\u{2212}5, lagrange");
}

#[test]
fn results_that_are_not_complete_say_how_much_is_missing() {
    let scratch = Scratch::with(study(20, 0.5, REST));
    assert_eq!(scratch.stickslip("run a.yaml --out out --max-seconds 0").code, Some(130));
    scratch.well("report out");
    let said = ["<strong>Not complete.</strong> 60 of 60 runs are missing (100.0 %)"];
    assert_has(&scratch.text("out-report.html"), &said);
    scratch.stickslip("run a.yaml --out part --shard 2/3 -q");
    scratch.well("report part");
    assert_has(&scratch.text("part-report.html"), &["; shard 2/3"]);
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let (scratch, _) = finished();
    // Only a page is replaced by a page.
    scratch.well("report out");
    scratch.well("report out");
    scratch
        .refused("report out --out a.yaml", &["a.yaml", "would overwrite", "found: ", "allowed: "]);
    for inside in ["out", "out/new.html", "out/chunks", "out/a/b.html"] {
        let said = ["lies in the directory of results", "found: ", "allowed: "];
        scratch.refused(&format!("report out --out {inside}"), &said);
    }
    fs::create_dir(scratch.path("folder")).unwrap();
    scratch.refused("report out --out folder", &["folder", "a directory", "allowed: "]);
    // A page that was edited is not overwritten.
    let written = scratch.text("out-report.html");
    let notes = format!("{written}<!-- my notes -->");
    for mine in
        [notes, format!("{written} "), format!(" {written}"), written.replace("<h1>", "<h2>")]
    {
        scratch.write("out-report.html", &mine);
        let said = ["found:   a report that has been changed since", "allowed: "];
        scratch.refused("report out", &said);
        assert_eq!(scratch.text("out-report.html"), mine);
    }
    fs::remove_file(scratch.path("out-report.html")).unwrap();
    // A table without a column, and a missing table.
    rewrite(&scratch, "time_to_rest", |batch| without(batch, "probability_at_rest"));
    let said =
        ["time_to_rest.parquet: column probability_at_rest: there is no such column", "allowed: "];
    scratch.refused("report out", &said);
    fs::remove_file(scratch.path("out/time_to_rest.parquet")).unwrap();
    scratch.refused("report out", &["time_to_rest.parquet: this is not the file that was written"]);
    let (scratch, _) = finished();
    kill(&scratch);
    scratch.well("report out");
    assert_has(&scratch.text("out-report.html"), &["0 of 60 runs are missing"]);
}
