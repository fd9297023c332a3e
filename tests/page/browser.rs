//! Chromium: where it is, and one of it for a test, with a profile of its own.

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

/// The descriptors that the browser speaks on are 3 and 4; a shell puts its pipes there.
const ON_PIPES: &str = r#"exec "$0" "$@" 3<&0 4>&1 0</dev/null 1>&2"#;

/// How long the browser may take to end by itself.
const FAREWELL: Duration = Duration::from_secs(5);

/// A running browser; it ends with this.
pub struct Browser {
    child: Child,
    /// None when the browser is to end.
    tools: Option<DevTools>,
    /// Its profile, and what it says on standard error.
    folder: TempDir,
}

impl Browser {
    /// Starts a browser; none where there is none and none is needed.
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
            // Nothing leaves this machine, whatever a page asks for.
            "--host-resolver-rules=MAP * ~NOTFOUND",
        ]);
        command.arg(format!("--user-data-dir={}", folder.path().join("profile").display()));
        // The superuser has no sandbox. Who we are shows in what we make.
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

    /// Calls a method of the protocol; panics with what the browser says where it cannot.
    #[track_caller]
    pub fn call(&mut self, session: Option<&str>, method: &str, parameters: Value) -> Value {
        let result = self.tools().call(session, method, parameters);
        result.unwrap_or_else(|error| self.fail(&error))
    }

    pub fn tools(&mut self) -> &mut DevTools {
        self.tools.as_mut().expect("taken when the browser ends only")
    }

    /// Opens a file.
    #[track_caller]
    pub fn open(&mut self, file: &Path, view: View) -> Page<'_> {
        Page::open(self, file, view)
    }

    #[track_caller]
    pub fn fail(&self, error: &str) -> ! {
        let said = fs::read_to_string(self.folder.path().join("stderr")).unwrap_or_default();
        // Of a bus that is not there it complains always.
        let said: Vec<&str> = said.lines().filter(|line| !line.contains("/dbus/")).collect();
        panic!("{error}\nThe browser said:\n{}", said.join("\n"));
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // With its pipes closed it ends, and all its processes with it.
        self.tools = None;
        let until = Instant::now() + FAREWELL;
        while matches!(self.child.try_wait(), Ok(None)) {
            if Instant::now() > until {
                // Its other processes follow the first one.
                let _ = self.child.kill();
                let _ = self.child.wait();
                break;
            }
            thread::sleep(Duration::from_millis(10));
        }
    }
}

/// The browser's program. Where there is none: said once, and a failure where tests must not be left out.
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
        // Straight to standard error: what a test prints is not shown where it passes.
        static ONCE: Once = Once::new();
        ONCE.call_once(|| stderr().write_all(format!("{missing}\n").as_bytes()).unwrap());
    }
    found
}
