//! The browser detects faults: each fault of a test page is reported.

use super::browser::Browser;
use super::page::{DARK, LAPTOP, View};
use super::results::Made;

const FAULTY: &str = r##"<!DOCTYPE html>
<html><head><meta charset="utf-8"><title>faults</title>
<style>
  p { color: #777; } @media print { .sheet { break-after: page; } }
  @media (prefers-color-scheme: dark) { :root { color-scheme: dark; } body { background: #000; } }
</style></head>
<body style="width: 3000px">
<p>grey</p><p style="color: #767676">darker</p><p style="opacity: 0.5; color: black">faint</p>
<p style="visibility: hidden">unseen</p>
<button></button><button id="named">named</button><input type="range">
<figure id="f"><div class="chart" style="width: 300px; height: 100px"><svg width="300" height="100" fill="currentColor">
  <text x="10" y="50">first</text><text x="20" y="52">second</text><text x="100" y="50">third</text>
  <text transform="translate(150 80) rotate(-30)">slanted</text>
  <text transform="translate(180 80) rotate(-30)">slanting</text><text x="290" y="20">beyond</text>
</svg></div></figure>
<div class="sheet">one</div><div class="sheet">two</div><div>three</div>
<script>
  console.log("nothing bad");
  console.warn("a warning");
  console.error("an error", 3);
  setTimeout(() => { throw new Error("thrown later"); }, 0);
  Promise.reject(new Error("a promise broken"));
  new Image().src = "https://example.org/pixel.png";
  new Image().src = "other.png";
  new Image().src = "data:image/gif;base64,R0lGODlhAQABAAAAACwAAAAAAQABAAA=";
  window.keys = [];
  addEventListener("keydown", event => keys.push(event.key + (event.shiftKey ? "+" : "")));
  document.getElementById("named").onclick = () => { window.clicked = true; };
</script></body></html>"##;

#[test]
fn faults_are_reported() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    let file = made.write("faulty.html", FAULTY);
    let mut page = browser.open(&file, LAPTOP);
    page.frames(3);
    let faults = page.faults().join("\n");
    for part in [
        "console, warning: a warning",
        "console, error: an error 3",
        "exception: Error: thrown later",
        "exception: Error: a promise broken",
        "request: https://example.org/pixel.png",
        "/other.png",
    ] {
        assert!(faults.contains(part), "no {part} in\n{faults}");
    }
    for part in ["nothing bad", "data:"] {
        assert!(!faults.contains(part), "{part} in\n{faults}");
    }
    assert!(page.wider_than_window());
    assert_eq!(page.overlapping(), ["f: first upon second", "f: beyond beyond the edge"]);
    let nameless: Vec<String> = page.nameless().into_iter().map(|part| part.role).collect();
    assert_eq!(nameless, ["button", "slider"]);

    // Grey 118 on white is the lightest colour that passes: 4.54 to 1. Half black on white is 3.95
    // to 1.
    let (pale, all) = page.pale();
    let words: Vec<&str> = pale.iter().map(|pale| pale.text.as_str()).collect();
    assert_eq!(words, ["grey", "faint"]);
    assert!((pale[0].ratio - 4.478).abs() < 1e-3 && (pale[1].ratio - 3.95).abs() < 0.05);
    assert_eq!(all, 13);
    page.view(DARK);
    let words: Vec<String> = page.pale().0.into_iter().map(|pale| pale.text).collect();
    assert_eq!(words, ["faint"]);

    assert_eq!(page.ask("window.clicked"), serde_json::Value::Null);
    page.click_on("#named");
    assert_eq!(page.ask("window.clicked"), true);
    page.key("Shift+ArrowLeft");
    page.key("Space");
    assert_eq!(page.text("keys.join()"), "ArrowLeft+, ");
    assert_eq!(page.pdf("faulty").sheets(), 3);
    page.view(View { print: true, ..LAPTOP });
    assert_eq!(page.ask("matchMedia('print').matches"), true);
}
