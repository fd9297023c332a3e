//! `stickslip new`: writes a commented study to start from.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use super::output::{CliError, End, print};
use crate::engine::say;
use crate::sanitize::shell_word;
use crate::study::Template;

const EXAMPLES: &str = "\
Examples:
  stickslip new balancer.yaml                           a ball balancer of your own
  stickslip new drive.yaml --template optimize
  stickslip new - --template thesis                     print it
  stickslip new --list                                  print the templates

The comment above each key of the study states its meaning, unit, range and default. The name of the study is the \
name of the file without its ending.";

/// Write a commented study to start from
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Study file to write, which must not exist; - for standard output
    #[arg(value_name = "FILE", required_unless_present = "list")]
    file: Option<PathBuf>,

    /// Template of the study
    #[arg(long, value_name = "NAME", default_value = "machine", value_parser = template())]
    template: Template,

    /// Print the templates, one per line
    #[arg(long, conflicts_with_all = ["file", "template"])]
    list: bool,
}

/// Returns a parser of the names of templates.
fn template() -> impl TypedValueParser<Value = Template> {
    let value = |template: Template| PossibleValue::new(template.name).help(template.summary);
    let names = PossibleValuesParser::new(Template::ALL.map(value));
    // The parser accepts no other names.
    names.map(|name| Template::find(&name).unwrap_or(Template::ALL[0]))
}

/// Writes a study.
pub fn new(arguments: &Arguments) -> Result<End, CliError> {
    let Some(file) = arguments.file.as_deref().filter(|_| !arguments.list) else {
        let line = |template: Template| format!("{:<12} {}\n", template.name, template.summary);
        print(&Template::ALL.map(line).concat())?;
        return Ok(End::Well);
    };
    let template = arguments.template;
    if file.as_os_str() == "-" {
        print(&template.text(template.name, Path::new("study.yaml"))?)?;
        return Ok(End::Well);
    }
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    write_new(file, &template.text(&name, file)?)?;
    let shown = shell_word(file);
    say(&format!(
        "{shown}: a study from the template `{}`; next: stickslip check {shown}",
        template.name
    ));
    Ok(End::Well)
}

/// Writes a file that must not exist.
fn write_new(file: &Path, text: &str) -> Result<(), CliError> {
    let refused = |problem: String, allowed: &str| {
        CliError::Usage(format!("{}: {problem}\n  allowed: {allowed}", file.display()))
    };
    let mut new = File::create_new(file).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => refused("exists already".to_owned(), "the name of a new file"),
        _ => {
            let allowed = "the name of a new file in a directory that can be written to";
            refused(error.to_string(), allowed)
        }
    })?;
    new.write_all(text.as_bytes()).map_err(|error| {
        // An incomplete study would prevent another attempt.
        let _ = std::fs::remove_file(file);
        refused(error.to_string(), "a file on a disk with enough space")
    })
}
