//! Chromium: its location, and one instance per test with its own profile.

use std::env;
use std::fs::{self, File};
use std::io::{Write, stderr};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Once;
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

use super::devtools::DevTools;
use super::page::{Page, View};

const NAMES: [&str; 5] =
    ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"];
const ELSEWHERE: [&str; 2] = [
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
];

/// The browser uses the descriptors 3 and 4; a shell connects its pipes to them.
const ON_PIPES: &str = r#"exec "$0" "$@" 3<&0 4>&1 0</dev/null 1>&2"#;

/// Time limit for the browser to end after its pipes are closed.
const FAREWELL: Duration = Duration::from_secs(5);

/// A running browser, which ends when this value is dropped.
pub struct Browser {
    child: Child,
    /// `None` when the browser is to end.
    tools: Option<DevTools>,
    /// Its profile, and its standard error.
    folder: TempDir,
}

impl Browser {
    /// Starts a browser; `None` if there is none and none is required.
    pub fn start() -> Option<Browser> {
        let program = program()?;
        let folder = TempDir::new().unwrap();
        let errors = File::create(folder.path().join("stderr")).unwrap();
        let mut command = Command::new("sh");
        command.args(["-c", ON_PIPES]).arg(&program).args([
            "--headless",
            "--remote-debugging-pipe",
            "--no-first-run",
            "--no-default-browser-check",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-breakpad",
            "--disable-dev-shm-usage",
            "--disable-gpu",
            "--force-color-profile=srgb",
            // No request leaves this machine, whatever a page requests.
            "--host-resolver-rules=MAP * ~NOTFOUND",
        ]);
        command.arg(format!("--user-data-dir={}", folder.path().join("profile").display()));
        // Root has no sandbox. The owner of a new directory is the current user.
        if fs::metadata(folder.path()).unwrap().uid() == 0 {
            command.arg("--no-sandbox");
        }
        command.arg("about:blank");
        let started = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(errors).spawn();
        let mut child = started.unwrap_or_else(|error| panic!("sh: {error}"));
        let (to, from) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
        let mut browser = Browser { child, tools: Some(DevTools::new(to, from)), folder };
        browser.call(None, "Browser.getVersion", json!({}));
        Some(browser)
    }

    /// Calls a method of the protocol; panics with the browser's message on failure.
    #[track_caller]
    pub fn call(&mut self, session: Option<&str>, method: &str, parameters: Value) -> Value {
        let result = self.tools().call(session, method, parameters);
        result.unwrap_or_else(|error| self.fail(&error))
    }

    pub fn tools(&mut self) -> &mut DevTools {
        self.tools.as_mut().expect("taken when the browser ends only")
    }

    #[track_caller]
    pub fn open(&mut self, file: &Path, view: View) -> Page<'_> {
        Page::open(self, file, view)
    }

    #[track_caller]
    pub fn fail(&self, error: &str) -> ! {
        let said = fs::read_to_string(self.folder.path().join("stderr")).unwrap_or_default();
        // It always complains about a missing bus.
        let said: Vec<&str> = said.lines().filter(|line| !line.contains("/dbus/")).collect();
        panic!("{error}\nThe browser said:\n{}", said.join("\n"));
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // With its pipes closed it ends with all its processes.
        self.tools = None;
        let until = Instant::now() + FAREWELL;
        while matches!(self.child.try_wait(), Ok(None)) {
            if Instant::now() > until {
                // Its other processes end after the first one.
                let _ = self.child.kill();
                let _ = self.child.wait();
                break;
            }
            thread::sleep(Duration::from_millis(10));
        }
    }
}

/// Returns the browser's program. A missing browser is reported once, and is a failure if the tests
/// are required.
fn program() -> Option<PathBuf> {
    if let Some(path) = env::var_os("STICKSLIP_CHROMIUM") {
        let path = PathBuf::from(path);
        assert!(path.is_file(), "STICKSLIP_CHROMIUM: {} is no file", path.display());
        return Some(path);
    }
    let path = env::var_os("PATH").unwrap_or_default();
    let on_path = env::split_paths(&path)
        .flat_map(|folder| NAMES.map(|name| folder.join(name)))
        .chain(ELSEWHERE.map(PathBuf::from));
    let found = on_path.into_iter().find(|file| file.is_file());
    if found.is_none() {
        let missing = "tests of pages did not run: there is no Chromium. apt-get install chromium, or \
                       STICKSLIP_CHROMIUM=path";
        assert!(env::var_os("CI").is_none(), "{missing}");
        // Directly to standard error, because the output of a passing test is hidden.
        static ONCE: Once = Once::new();
        ONCE.call_once(|| stderr().write_all(format!("{missing}\n").as_bytes()).unwrap());
    }
    found
}
