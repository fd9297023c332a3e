//! The pages that the program makes, in a real browser: Chromium without a window, driven through its
//! DevTools protocol.
//!
//! - It is looked for on the path; `STICKSLIP_CHROMIUM=path` names another. Where there is none, the tests
//!   say so and pass, unless `CI` is set.
//! - `STICKSLIP_SCREENSHOTS=folder` keeps what is seen and printed, to be looked at.
#![cfg(unix)]

/// The browser: found, started, ended.
mod browser;
/// What the browser tells of a page that has faults.
mod browser_tells;
/// Its protocol.
mod devtools;
/// Pages that the program makes.
mod made;
/// A page in the browser.
mod page;
/// `replay.html`.
mod replay;
/// The page of a report.
mod report;
/// The page of a report of very many runs.
mod report_large;
