//! Readers of YAML 1.1, such as PyYAML, read shipped and resolved studies as readers of YAML 1.2 do.

use stickslip::study::Study;

use super::{study, text_with_design};
use crate::support::study_files;

/// The words that YAML 1.1 reads as truth values or as nothing.
const WORDS: [&str; 9] = ["y", "n", "yes", "no", "on", "off", "null", "true", "false"];

/// Returns the plain scalars of a YAML text, without quoted texts, comments and punctuation.
fn plain_scalars(text: &str) -> Vec<String> {
    let mut plain = String::new();
    for line in text.lines() {
        let (mut quote, mut before) = (None, ' ');
        for character in line.chars() {
            match (quote, character) {
                (None, '#') if before == ' ' => break,
                (None, '"' | '\'') => quote = Some(character),
                (Some(open), _) if open == character => quote = None,
                (Some(_), _) => {}
                (None, '[' | ']' | '{' | '}' | ',') => plain.push(' '),
                (None, _) => plain.push(character),
            }
            before = character;
        }
        plain.push('\n');
    }
    plain.split_whitespace().map(|word| word.trim_end_matches(':').to_owned()).collect()
}

/// Returns whether YAML 1.1 reads a number of YAML 1.2 as the same number: a point and a signed exponent, or an integer
/// without a leading zero, which is octal there.
fn is_same_number(word: &str) -> bool {
    let digits = word.trim_start_matches(['+', '-']);
    let all_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    match digits.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => mantissa.contains('.') && exponent.starts_with(['+', '-']),
        None if all_digits(digits) => digits == "0" || !digits.starts_with('0'),
        None => digits.contains('.'),
    }
}

/// Returns the first word that the two versions read differently.
fn differently_read(text: &str) -> Option<String> {
    let differs = |word: &String| {
        let starts =
            word.starts_with(|first: char| first.is_ascii_digit() || "+-.".contains(first));
        let is_number = starts && word.parse::<f64>().is_ok();
        let is_time = word.contains(':') && word.starts_with(|first: char| first.is_ascii_digit());
        let is_word = WORDS.contains(&word.to_ascii_lowercase().as_str());
        (is_number && !is_same_number(word))
            || is_time
            || is_word && !["true", "false"].contains(&word.as_str())
    };
    plain_scalars(text).into_iter().find(differs)
}

#[test]
fn words_that_the_versions_read_differently_are_found() {
    for text in
        ["a: 1e4", "a: 1.05e4", "a: [1, 1e-8]", "on: 1", "{y: [1]}", "a: 12:30", "a: 010", "a: No"]
    {
        assert!(differently_read(text).is_some(), "{text}");
    }
    for text in
        ["a: 1.0e+4", "a: -1.05e-4 # 1e4", "\"y\": 1", "a: 0.5", "a: '1e4'", "b: true", "a: 10"]
    {
        assert_eq!(differently_read(text), None, "{text}");
    }
}

#[test]
fn shipped_and_resolved_studies_are_read_alike() {
    let mut seen = 0;
    for path in ["studies", "benches"].into_iter().flat_map(study_files) {
        let text = std::fs::read_to_string(&path).expect("a study");
        assert_eq!(differently_read(&text), None, "{}", path.display());
        let resolved = Study::load(&path).expect("a study").resolved_yaml();
        assert_eq!(differently_read(&resolved), None, "{resolved}");
        seen += 1;
    }
    assert!(seen > 20, "{seen} studies");
}

#[test]
fn hard_numbers_and_words_are_read_alike_and_keep_their_values() {
    let text = text_with_design("{monte_carlo: {samples: 3}}");
    let text = format!(
        "{text}  box: {{y: [-1e-9, 1e-7]}}\nsweep: [{{grid: {{speed_rad_s: [1e300, -1.5e-300, 1e21, 3]}}}}]\n\
         responses: {{on: median_time_to_rest, no: {{amplitude_mean: {{}}}}, n: median_time_to_rest}}\n"
    );
    let first = study(&text.replace("name: a", "name: \"12\""));
    let resolved = first.resolved_yaml();
    assert_eq!(differently_read(&resolved), None, "{resolved}");
    for line in
        ["    \"y\": [-1.0e-9, 1.0e-7]", "      speed_rad_s: [1.0e+300, -1.5e-300, 1.0e+21, 3.0]"]
    {
        assert!(resolved.contains(line), "{line}\n{resolved}");
    }
    let again = study(&resolved);
    assert_eq!((again.hash(), again.resolved_yaml()), (first.hash(), resolved));
}
