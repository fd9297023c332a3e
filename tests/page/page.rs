//! A page from its reader's point of view: displayed, clicked, operated by keys, printed; and its
//! faults.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};

use super::browser::Browser;
use super::devtools::{Event, TIME};

/// The settings of a view.
#[derive(Clone, Copy, Debug)]
pub struct View {
    pub width: u32,
    pub height: u32,
    /// The reader's preferences.
    pub dark: bool,
    pub reduced_motion: bool,
    /// On paper, not on a screen.
    pub print: bool,
}

/// A laptop in light mode.
pub const LAPTOP: View =
    View { width: 1280, height: 720, dark: false, reduced_motion: false, print: false };
/// A laptop in dark mode.
pub const DARK: View = View { dark: true, ..LAPTOP };

/// Minimum contrast of text that is not large (WCAG 2.2, 1.4.3).
pub const CONTRAST: f64 = 4.5;

pub struct Page<'a> {
    browser: &'a mut Browser,
    target: String,
    session: String,
    address: String,
}

/// A part of a page in its accessibility tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Accessible {
    pub role: String,
    pub name: String,
}

/// Text with too little contrast to its background.
#[derive(Clone, Debug, PartialEq)]
pub struct Pale {
    pub text: String,
    pub ratio: f64,
}

pub struct Pdf {
    pub bytes: Vec<u8>,
}

impl Pdf {
    pub fn sheets(&self) -> usize {
        let text = String::from_utf8_lossy(&self.bytes);
        let of_sheets = text.split("/Type /Page").skip(1).filter(|rest| !rest.starts_with('s'));
        of_sheets.count()
    }
}

impl<'a> Page<'a> {
    /// Opens a file, and waits until it is loaded and drawn.
    #[track_caller]
    pub fn open(browser: &'a mut Browser, file: &Path, view: View) -> Self {
        let file = file.canonicalize().unwrap();
        let address = format!("file://{}", file.display());
        let blank = json!({"url": "about:blank"});
        let made = browser.call(None, "Target.createTarget", blank);
        let target = made["targetId"].as_str().unwrap().to_owned();
        let attach = json!({"targetId": target, "flatten": true});
        let attached = browser.call(None, "Target.attachToTarget", attach);
        let session = attached["sessionId"].as_str().unwrap().to_owned();
        let mut page = Page { browser, target, session, address };
        page.view(view);
        for domain in ["Runtime", "Log", "Network", "Page", "Accessibility", "DOM"] {
            page.call(&format!("{domain}.enable"), json!({}));
        }
        let address = page.address.clone();
        page.call("Page.navigate", json!({"url": address}));
        let session = page.session.clone();
        let loaded = |event: &Event| {
            event.method == "Page.loadEventFired" && event.session.as_ref() == Some(&session)
        };
        if let Err(error) = page.browser.tools().wait_for("the page", loaded) {
            page.browser.fail(&error);
        }
        page.frames(2);
        page
    }

    #[track_caller]
    fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.browser.call(Some(&self.session), method, parameters)
    }

    #[track_caller]
    pub fn view(&mut self, view: View) {
        let View { width, height, dark, reduced_motion, print } = view;
        let size =
            json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", size);
        // Paper has no scroll bars.
        self.call("Emulation.setScrollbarsHidden", json!({"hidden": print}));
        let scheme = if dark { "dark" } else { "light" };
        let motion = if reduced_motion { "reduce" } else { "no-preference" };
        let media = json!({
            // An empty value restores the default. An emulated screen would remain when the page is
            // printed.
            "media": if print { "print" } else { "" },
            "features": [
                {"name": "prefers-color-scheme", "value": scheme},
                {"name": "prefers-reduced-motion", "value": motion},
            ],
        });
        self.call("Emulation.setEmulatedMedia", media);
    }

    /// Waits until this number of frames has been drawn.
    #[track_caller]
    pub fn frames(&mut self, count: u32) {
        self.ask(&format!(
            "new Promise(done => {{
                let left = {count};
                const next = () => left-- > 0 ? requestAnimationFrame(next) : done(null);
                next();
            }})"
        ));
    }

    /// Returns the value of an expression as JSON; awaits a promise.
    #[track_caller]
    pub fn ask(&mut self, expression: &str) -> Value {
        let question = json!({
            "expression": expression, "returnByValue": true, "awaitPromise": true,
        });
        let mut answer = self.call("Runtime.evaluate", question);
        if let Some(thrown) = answer.get("exceptionDetails") {
            panic!("{expression}\n{}", described(thrown));
        }
        answer["result"]["value"].take()
    }

    /// Returns the value of an expression, which must be a number.
    #[track_caller]
    pub fn number(&mut self, expression: &str) -> f64 {
        let value = self.ask(expression);
        value.as_f64().unwrap_or_else(|| panic!("{expression}: {value}"))
    }

    /// Returns the value of an expression, which must be a text.
    #[track_caller]
    pub fn text(&mut self, expression: &str) -> String {
        let value = self.ask(expression);
        value.as_str().unwrap_or_else(|| panic!("{expression}: {value}")).to_owned()
    }

    #[track_caller]
    pub fn wait_until(&mut self, expression: &str) {
        let until = Instant::now() + TIME;
        while !self.ask(&format!("Boolean({expression})")).as_bool().unwrap() {
            assert!(Instant::now() < until, "did not come: {expression}");
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Returns the middle of an element, scrolled into view.
    #[track_caller]
    pub fn middle(&mut self, selector: &str) -> (f64, f64) {
        let place = self.ask(&format!(
            "(() => {{
                const found = document.querySelector({selector:?});
                found.scrollIntoView({{block: 'nearest', behavior: 'instant'}});
                const box = found.getBoundingClientRect();
                return [box.x + box.width / 2, box.y + box.height / 2];
            }})()"
        ));
        (place[0].as_f64().unwrap(), place[1].as_f64().unwrap())
    }

    /// Moves the mouse, in pixels from the window's upper left corner.
    #[track_caller]
    pub fn move_to(&mut self, (x, y): (f64, f64)) {
        self.call("Input.dispatchMouseEvent", json!({"type": "mouseMoved", "x": x, "y": y}));
    }

    #[track_caller]
    pub fn click(&mut self, (x, y): (f64, f64)) {
        self.move_to((x, y));
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({"type": kind, "x": x, "y": y, "button": "left", "clickCount": 1});
            self.call("Input.dispatchMouseEvent", event);
        }
    }

    #[track_caller]
    pub fn click_on(&mut self, selector: &str) {
        let place = self.middle(selector);
        self.click(place);
    }

    /// Presses and releases a key; `Shift+` may precede its name.
    #[track_caller]
    pub fn key(&mut self, name: &str) {
        let (modifiers, name) = match name.strip_prefix("Shift+") {
            Some(name) => (8, name),
            None => (0, name),
        };
        let (key, code, number, text) = match name {
            "Space" => (" ", "Space", 32, " "),
            "Enter" => ("Enter", "Enter", 13, "\r"),
            "Tab" => ("Tab", "Tab", 9, ""),
            "Escape" => ("Escape", "Escape", 27, ""),
            "End" => ("End", "End", 35, ""),
            "Home" => ("Home", "Home", 36, ""),
            "ArrowLeft" => (name, name, 37, ""),
            "ArrowUp" => (name, name, 38, ""),
            "ArrowRight" => (name, name, 39, ""),
            "ArrowDown" => (name, name, 40, ""),
            _ => panic!("{name}: no such key here"),
        };
        let event = |kind: &str, text: &str| {
            json!({
                "type": kind, "key": key, "code": code, "windowsVirtualKeyCode": number,
                "text": text, "modifiers": modifiers,
            })
        };
        let down = if text.is_empty() { "rawKeyDown" } else { "keyDown" };
        self.call("Input.dispatchKeyEvent", event(down, text));
        self.call("Input.dispatchKeyEvent", event("keyUp", ""));
    }

    /// Returns the faults of the page so far: warnings, errors, exceptions, and requests of
    /// external resources.
    pub fn faults(&mut self) -> Vec<String> {
        // Events are sent before the answer to a later question.
        self.ask("null");
        let (session, address) = (&self.session, &self.address);
        let events = &self.browser.tools().events;
        let of_page = events.iter().filter(|event| event.session.as_ref() == Some(session));
        of_page.filter_map(|event| fault(event, address)).collect()
    }

    /// Returns role and name of each part of the page in the accessibility tree that is not
    /// ignored.
    #[track_caller]
    pub fn accessible(&mut self) -> Vec<Accessible> {
        let tree = self.call("Accessibility.getFullAXTree", json!({}));
        let nodes = tree["nodes"].as_array().unwrap();
        let word =
            |node: &Value, key: &str| node[key]["value"].as_str().unwrap_or_default().to_owned();
        nodes
            .iter()
            .filter(|node| node["ignored"] != true)
            // Some versions of the browser keep the space between a label and its control.
            .map(|node| Accessible {
                role: word(node, "role"),
                name: word(node, "name").trim().to_owned(),
            })
            .collect()
    }

    #[track_caller]
    pub fn nameless(&mut self) -> Vec<Accessible> {
        const CONTROLS: [&str; 12] = [
            "button",
            "checkbox",
            "combobox",
            "graphics-document",
            "image",
            "link",
            "listbox",
            "radio",
            "slider",
            "spinbutton",
            "tab",
            "textbox",
        ];
        let mut all = self.accessible();
        all.retain(|part| CONTROLS.contains(&part.role.as_str()) && part.name.trim().is_empty());
        all
    }

    /// Returns the text with too little contrast, and the amount of examined text.
    #[track_caller]
    pub fn pale(&mut self) -> (Vec<Pale>, usize) {
        let found = self.ask(include_str!("contrast.js"));
        let texts = found.as_array().unwrap();
        let pale = texts.iter().map(|text| Pale {
            text: text["text"].as_str().unwrap().to_owned(),
            ratio: text["ratio"].as_f64().unwrap(),
        });
        (pale.filter(|text| text.ratio < CONTRAST).collect(), texts.len())
    }

    /// Returns labels of charts that overlap each other or the edge of their chart.
    #[track_caller]
    pub fn overlapping(&mut self) -> Vec<String> {
        let found = self.ask(include_str!("overlapping.js"));
        serde_json::from_value(found).unwrap()
    }

    #[track_caller]
    pub fn wider_than_window(&mut self) -> bool {
        self.number("document.documentElement.scrollWidth - document.documentElement.clientWidth")
            > 0.0
    }

    /// Stores a screenshot of the whole page if requested.
    #[track_caller]
    pub fn screenshot(&mut self, name: &str) {
        let Some(path) = kept(name, "png") else { return };
        let metrics = self.call("Page.getLayoutMetrics", json!({}));
        let mut clip = metrics["cssContentSize"].clone();
        clip["scale"] = 1.into();
        let whole = json!({"format": "png", "captureBeyondViewport": true, "clip": clip});
        let picture = self.call("Page.captureScreenshot", whole);
        fs::write(path, bytes(&picture)).unwrap();
    }

    /// Returns the page as printed, in A4.
    #[track_caller]
    pub fn pdf(&mut self, name: &str) -> Pdf {
        let paper = json!({"paperWidth": 8.27, "paperHeight": 11.69, "preferCSSPageSize": true});
        let bytes = bytes(&self.call("Page.printToPDF", paper));
        if let Some(path) = kept(name, "pdf") {
            fs::write(path, &bytes).unwrap();
        }
        Pdf { bytes }
    }
}

impl Drop for Page<'_> {
    fn drop(&mut self) {
        let close = json!({"targetId": self.target});
        // A browser that has ended has no pages.
        let _ = self.browser.tools().call(None, "Target.closeTarget", close);
    }
}

fn bytes(answer: &Value) -> Vec<u8> {
    BASE64_STANDARD.decode(answer["data"].as_str().unwrap()).unwrap()
}

/// Returns the path for a picture; `None` unless pictures are requested.
pub fn kept(name: &str, kind: &str) -> Option<PathBuf> {
    let folder = PathBuf::from(env::var_os("STICKSLIP_SCREENSHOTS")?);
    fs::create_dir_all(&folder).unwrap();
    Some(folder.join(format!("{name}.{kind}")))
}

/// Returns the fault of the page at this address that an event reports.
fn fault(event: &Event, address: &str) -> Option<String> {
    let told = &event.told;
    match event.method.as_str() {
        "Runtime.exceptionThrown" => {
            Some(format!("exception: {}", described(&told["exceptionDetails"])))
        }
        "Runtime.consoleAPICalled" => {
            let kind = told["type"].as_str()?;
            let values = told["args"].as_array()?.iter();
            let words: Vec<String> = values
                .map(|value| match &value["value"] {
                    Value::String(text) => text.clone(),
                    other => other.to_string(),
                })
                .collect();
            ["warning", "error", "assert"]
                .contains(&kind)
                .then(|| format!("console, {kind}: {}", words.join(" ")))
        }
        "Log.entryAdded" => {
            let entry = &told["entry"];
            let level = entry["level"].as_str()?;
            ["warning", "error"]
                .contains(&level)
                .then(|| format!("log, {level}: {}", entry["text"].as_str().unwrap_or_default()))
        }
        "Network.requestWillBeSent" => {
            let asked = told["request"]["url"].as_str()?;
            let inside = asked.starts_with("data:") || asked.starts_with("blob:");
            (asked != address && !inside).then(|| format!("request: {asked}"))
        }
        _ => None,
    }
}

fn described(thrown: &Value) -> String {
    let of_value = thrown["exception"]["description"].as_str();
    of_value.or(thrown["text"].as_str()).unwrap_or("something was thrown").to_owned()
}
