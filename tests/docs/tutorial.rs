//! The steps of the tutorial work, with fewer runs and designs.

use crate::cli::support::Scratch;

const TUTORIAL: &str = include_str!("../../docs/tutorial.md");

/// Returns the code blocks of a language in order, with their start lines.
fn blocks(language: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut inside: Option<(usize, String)> = None;
    for (number, line) in TUTORIAL.lines().enumerate() {
        match (&mut inside, line.strip_prefix("```")) {
            (Some((_, text)), None) => *text += &format!("{line}\n"),
            (Some(_), Some(_)) => found.extend(inside.take()),
            (None, Some(name)) if name == language => inside = Some((number, String::new())),
            (None, Some(name)) if !name.is_empty() => inside = None,
            _ => {}
        }
    }
    found
}

#[test]
fn every_step_of_the_tutorial() {
    let scratch = Scratch::new();
    scratch.write("designs.csv", &blocks("csv")[0].1);
    let mut steps: Vec<(usize, &str, String)> = Vec::new();
    steps.extend(blocks("yaml").into_iter().map(|(place, text)| (place, "yaml", text)));
    steps.extend(blocks("sh").into_iter().map(|(place, text)| (place, "sh", text)));
    steps.sort();
    let (mut study, mut commands) = (String::new(), 0);
    for (_, language, text) in steps {
        if language == "yaml" {
            study +=
                &text.replace("samples: 128", "samples: 8").replace("designs: 60", "designs: 12");
            scratch.write("drive.yaml", &study);
            continue;
        }
        for line in text.lines() {
            let arguments = line.strip_prefix("stickslip ").expect("a command of this program");
            let ended = scratch.stickslip(arguments);
            // With so few runs the limit may not be met.
            let allowed = if line.contains("optimize") { vec![0, 4] } else { vec![0] };
            assert!(allowed.contains(&ended.code.unwrap()), "{line}\n{}{}", ended.out, ended.err);
            commands += 1;
        }
    }
    assert_eq!(commands, 6);
    for file in ["runs/points.parquet", "responses.parquet", "optimum/sensitivities.parquet"] {
        assert!(scratch.path(file).exists(), "{file}");
    }
    let optimum = scratch.text("optimum/optimum.json");
    let optimum: serde_json::Value = serde_json::from_str(&optimum).unwrap();
    assert_eq!(optimum["search"]["designs"], 12);
    assert!(optimum["best_over_compare_with"][0]["ratio"]["value"].is_number(), "{optimum}");
}
