//! Runs a script at the end of a copy of a page in a headless Chromium, and returns what the script found.
//!
//! ```text
//!     page + listener + script --> file --chromium --dump-dom--> DOM --> argument of found() in the script, as JSON
//! ```

use crate::parsed;
use percent_encoding::percent_decode_str;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The environment variable that names a browser, which must then run.
const VARIABLE: &str = "HEELSTRIKE_BROWSER";

/// Time limit of one page, longer than any takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// Runs before the page's own script and records errors and violations of the page's policy, such as requests.
const LISTENER: &str = include_str!("scripts/listener.js");

/// Helpers at the page's end, for the test's script.
const TOOLS: &str = include_str!("scripts/tools.js");

/// Runs `script` in the page of this file, in a window of this size, and returns what it found. `None`, with a note, if
/// there is no browser.
pub fn found(page: &Path, window: (u32, u32), script: &str) -> Option<Value> {
    let browser = browser()?;
    let html = std::fs::read_to_string(page).expect("a page");
    let html = html.replacen("<head>", &format!("<head><script>{LISTENER}</script>"), 1);
    let (html, end) = html.rsplit_once("</body>").expect("a body");
    let name = page.file_stem().and_then(|name| name.to_str()).expect("a name");
    let number = std::thread::current().id();
    let driven = page.with_file_name(format!("{name}-{number:?}-driven.html"));
    std::fs::write(&driven, format!("{html}<script>{{{TOOLS}{script}}}</script></body>{end}")).expect("written");
    let profile = page.with_file_name(format!("{name}-{number:?}-profile"));
    let dom = dumped(&browser, &driven, &profile, window);
    let (_, rest) = dom.split_once(r#"<pre id="found">"#).unwrap_or_else(|| panic!("the script failed:\n{dom}"));
    let (found, _) = rest.split_once("</pre>").expect("its end");
    // `found` in tools.js encodes its JSON by `encodeURIComponent`.
    let found = parsed(&percent_decode_str(found).decode_utf8().expect("UTF-8"));
    assert_eq!(found["wrong"], serde_json::json!([]));
    assert_eq!(found["loaded"], 0);
    Some(found)
}

/// The name of a browser that runs; `None`, with a note, if there is none.
fn browser() -> Option<String> {
    if let Some(name) = std::env::var(VARIABLE).ok().filter(|name| !name.is_empty()) {
        assert!(runs(&name), "{VARIABLE} names {name}, which does not run");
        return Some(name);
    }
    let known = ["chromium", "chromium-browser", "google-chrome"];
    let browser = known.into_iter().find(|name| runs(name)).map(str::to_owned);
    if browser.is_none() {
        eprintln!("skipped: none of {known:?} is installed; {VARIABLE}=NAME makes that an error");
    }
    browser
}

fn runs(name: &str) -> bool {
    let mut command = Command::new(name);
    let command = command.arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

/// The document after the script has run.
fn dumped(browser: &str, page: &Path, profile: &Path, (width, height): (u32, u32)) -> String {
    let mut child = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-extensions"])
        .args(["--host-resolver-rules=MAP * ~NOTFOUND", "--virtual-time-budget=30000", "--dump-dom"])
        .arg(format!("--window-size={width},{height}"))
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(format!("file://{}", page.display()))
        .stdin(Stdio::null())
        .stdout(Stdio::from(std::fs::File::create(page.with_extension("dom")).expect("a file")))
        .stderr(Stdio::null())
        .spawn()
        .expect("the browser starts");
    let start = Instant::now();
    while child.try_wait().expect("a child").is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().expect("it ends");
            panic!("the browser did not end");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    std::fs::read_to_string(page.with_extension("dom")).expect("UTF-8")
}
