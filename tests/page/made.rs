//! A folder, and what the program makes in it.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use tempfile::TempDir;

/// A directory that goes away with the test.
pub struct Made(TempDir);

impl Made {
    pub fn new() -> Self {
        Made(TempDir::new().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file.
    pub fn write(&self, name: &str, content: &str) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, content).unwrap();
        path
    }

    /// The program with these arguments, separated by blanks, which must end well.
    #[track_caller]
    pub fn well(&self, arguments: &str) -> String {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
        command.args(arguments.split_whitespace()).current_dir(self.0.path());
        let output = command.stdin(Stdio::null()).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments}\n{said}");
        String::from_utf8(output.stdout).unwrap()
    }
}
