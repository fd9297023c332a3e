//! The program's pages in a real browser: headless Chromium, driven through its DevTools protocol.
//!
//! - The browser is found on the path; `STICKSLIP_CHROMIUM=path` names another. Without a browser,
//!   the tests say so and pass, unless `CI` is set.
//! - `STICKSLIP_SCREENSHOTS=folder` stores screenshots and prints for inspection.
#![cfg(unix)]

/// The browser: found, started, ended.
mod browser;
/// Faults of a page that the browser reports.
mod browser_tells;
/// The DevTools protocol.
mod devtools;
/// A page in the browser.
mod page;
/// `replay.html`.
mod replay;
/// The page of a report.
mod report;
/// The page of a report of very many runs.
mod report_large;
/// Pages that the program creates.
mod results;
