//! `stickslip evaluate --designs -`: malformed requests, and clients that disconnect.

use std::io::{BufRead, BufReader, Write};

use serde_json::{Value, json};

use super::evaluate::{BALLS, BLOCK, ask, scratch, server};
use super::support::{Ended, json_lines};

fn answers(input: &[u8]) -> Vec<Value> {
    let ended = scratch().fed("evaluate balls.yaml --designs - --quiet", input);
    assert_eq!((ended.code, ended.err.as_str()), (Some(0), ""));
    json_lines(&ended.out)
}

const RIGHT: &str = r#"{"id": "right", "speed_rad_s": -200, "balls": 1, "material": "steel"}"#;

/// A valid request with another speed.
fn with_speed(speed: &str) -> String {
    RIGHT.replace("-200", speed)
}

#[test]
fn odd_lines_are_answered_and_the_next_one_is_served() {
    let deep = |depth| with_speed(&format!("{}{}", "[".repeat(depth), "]".repeat(depth)));
    let not_a_request: Vec<Vec<u8>> = vec![
        with_speed("NaN").into(),
        with_speed("-Infinity").into(),
        with_speed("1e999").into(),
        with_speed("0x10").into(),
        with_speed("-").into(),
        deep(100_000).into(),
        b"".to_vec(),
        b" \t".to_vec(),
        b"\0".to_vec(),
        b"null".to_vec(),
        b"\"speed_rad_s\"".to_vec(),
        b"{\"id\": \"\xff\xfe\", \"balls\": 2}".to_vec(),
        b"\xff\xfe{\x00}\x00".to_vec(),
        format!("{RIGHT} {RIGHT}").into(),
        RIGHT[..RIGHT.len() - 1].into(),
        format!("[{RIGHT}]").into(),
        format!("\u{feff}{RIGHT}").into(),
    ];
    let too_long = with_speed(&format!("\"{}\"", "x".repeat(3 << 20)));
    let of_the_speed = [
        ("[-200]".to_owned(), "neither a number nor text"),
        ("{\"value\": -200}".to_owned(), "neither a number nor text"),
        ("true".to_owned(), "neither a number nor text"),
        ("null".to_owned(), "neither a number nor text"),
        (format!("[{}]", "1,".repeat(100_000) + "1"), "neither a number nor text"),
        (format!("\"{}\"", "y".repeat(500_000)), "not a number"),
        ("\"-200\"".to_owned(), "not a number"),
        ("123456789012345678901234567890".to_owned(), "out of range"),
        ("-1e308".to_owned(), "out of range"),
        ("-139.99999999999997".to_owned(), "out of range"),
    ];
    let mut lines = not_a_request.clone();
    lines.push(too_long.into());
    lines.extend(of_the_speed.iter().map(|(speed, _)| with_speed(speed).into()));
    // The longest line, with its end.
    lines.push(format!("{RIGHT}{}\r", " ".repeat((1 << 20) - RIGHT.len() - 2)).into());
    lines.push(RIGHT.replacen('{', "{\"id\": 2, ", 1).into());
    lines.push(RIGHT.replace("\"right\"", &format!("[{}]", "7,".repeat(50_000) + "7")).into());
    lines.push(RIGHT.into());
    // A byte order mark at the start, and a last line without its end.
    let input = [b"\xef\xbb\xbf", RIGHT.as_bytes(), b"\n", &lines.join(&b'\n')].concat();
    let answers = answers(&input);
    assert_eq!(answers.len(), lines.len() + 1);
    let right = answers[answers.len() - 1].clone();
    assert!(right["responses"]["mean"]["value"].is_f64(), "{right}");

    let mut rest = answers.iter();
    assert_eq!(rest.next().unwrap()["responses"], right["responses"]);
    for (line, answer) in not_a_request.iter().zip(rest.by_ref()) {
        let line = String::from_utf8_lossy(line);
        assert_eq!(answer["id"], Value::Null, "{line}");
        assert_eq!(answer["error"]["problem"], "not a request", "{line}");
        assert!(answer.to_string().len() < 600, "{answer}");
    }
    assert_eq!(rest.next().unwrap()["error"]["problem"], "line too long");
    for ((speed, problem), answer) in of_the_speed.iter().zip(rest.by_ref()) {
        let error = &answer["error"];
        assert_eq!(
            (&answer["id"], &error["variable"], &error["problem"]),
            (&json!("right"), &json!("speed_rad_s"), &json!(problem)),
            "{speed:.40}"
        );
        assert!(answer.to_string().len() < 600, "{answer}");
    }
    assert_eq!(rest.next().unwrap()["responses"], right["responses"], "a line of Windows");
    assert_eq!(rest.next().unwrap()["error"]["problem"], "given twice");
    let large = rest.next().unwrap();
    assert_eq!(large["id"].as_array().map(Vec::len), Some(50_001), "an id is anything");
    assert_eq!(large["responses"], right["responses"]);
}

/// Each answer is compared with the nearest different design before it. The block stops after 0.52
/// s at 36 N/m, and at 100 N/m after 0.63 s, when its runs have ended.
#[test]
fn discontinuities_among_requests() {
    let scratch = scratch();
    let text = BLOCK.replace("samples: 4", "samples: 16");
    let text = text.replace("method: event,", "method: event, end_time_s: 0.6,");
    scratch.write("step.yaml", &text);
    let requests = [36, 40, 100, 36, 99].map(|k| json!({"stiffness_n_m": k}));
    let found = ask(&scratch, "evaluate step.yaml --designs -", &requests);
    let flags: Vec<&Value> = found.iter().map(|answer| &answer["discontinuous"]).collect();
    assert_eq!(flags, [&json!(null), &json!(false), &json!(true), &json!(false), &json!(false)]);
    // The table reports the same step, from both sides.
    scratch.write("k.csv", "stiffness_n_m\n36\n40\n100\n99\n");
    scratch.well("evaluate step.yaml --designs k.csv --out k.parquet --quiet");
    let rows = super::support::table(&scratch.path("k.parquet"));
    let flags = super::support::column(&rows, "discontinuous");
    let flags: Vec<Option<bool>> = arrow::array::AsArray::as_boolean(flags).iter().collect();
    assert_eq!(flags, [Some(false); 4], "neighbours are 36 and 40, 99 and 100");
    // At each point of a sweep: with a quarter of the force it stops at neither stiffness in time.
    let swept = format!("{text}sweep: [{{grid: {{normal_force_n: [10, 2.5]}}}}]\n");
    scratch.write("swept.yaml", swept);
    let found = ask(&scratch, "evaluate swept.yaml --designs -", &requests[..3]);
    let points =
        |answer: &Value| [0, 1].map(|point| answer["points"][point]["discontinuous"].clone());
    assert_eq!(points(&found[0]), [json!(null), json!(null)]);
    assert_eq!(points(&found[2]), [json!(true), json!(false)]);
}

/// A response that no run supports is null with a reason, also if all runs fail.
#[test]
fn responses_that_no_run_supports() {
    let scratch = scratch();
    let failing = "uncertain:\n  ball_diameter_m: {normal: {mean: -1, std_dev: 1e-6}}\n ";
    let text = BALLS.replace("uncertain:\n ", failing);
    scratch.write("failing.yaml", text);
    let request = r#"{"speed_rad_s": -200, "balls": 1, "material": "steel"}"#;
    let answer = &ask(&scratch, "evaluate failing.yaml --designs -", &[request])[0];
    assert_eq!((&answer["runs"], &answer["failed"]), (&json!(24), &json!(24)));
    for (name, response) in answer["responses"].as_object().unwrap() {
        for key in ["value", "standard_error", "low", "high"] {
            assert_eq!(response[key], Value::Null, "{name} {key}");
        }
        let reason = response["reason"].as_str().unwrap_or_else(|| panic!("{name}: no reason"));
        let expected = ["no run has an amplitude", "all runs failed", "no run came to rest"];
        assert!(expected.contains(&reason), "{name}: {reason}");
    }
}

/// A client may disconnect at any point: before its first request, within a line, with unread
/// answers, and during a computation.
#[test]
fn hanging_up_at_any_point() {
    let scratch = scratch();
    let text = BALLS.replace("samples: 24", "samples: 400");
    scratch.write("long.yaml", text);
    let request = format!("{RIGHT}\n");
    for sent in ["", "{\"id\":", RIGHT, &request, &request.repeat(50)] {
        for reads in [false, true] {
            let mut child = server(&scratch, "evaluate long.yaml --designs - --quiet");
            let mut input = child.stdin.take().unwrap();
            let mut output = BufReader::new(child.stdout.take().unwrap());
            input.write_all(sent.as_bytes()).unwrap();
            if reads && sent.ends_with('\n') {
                output.read_line(&mut String::new()).unwrap();
            }
            drop((output, input));
            let ended = Ended::of(child.wait_with_output().unwrap());
            assert_eq!((ended.code, ended.err.as_str()), (Some(0), ""), "after {sent:.20} {reads}");
        }
    }
}
