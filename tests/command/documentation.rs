//! README and docs against the tool: the tool prints what they show, links have targets, and every field is named.

use super::{RAMONE, Run, Value, WALKER, finished, heelstrike, parsed, place, read};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::{env, fs};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// The Markdown files of these folders, by path.
fn pages(folders: &[&str]) -> BTreeMap<PathBuf, String> {
    let files = folders.iter().flat_map(|folder| fs::read_dir(Path::new(ROOT).join(folder)).expect("a folder"));
    let paths = files.map(|file| file.expect("a file").path()).filter(|path| path.extension() == Some("md".as_ref()));
    paths.map(|path| (path.clone(), fs::read_to_string(&path).expect("a page"))).collect()
}

/// The fenced blocks of a page as language and content, or, unless `fenced`, the text between them.
fn blocks(page: &str, fenced: bool) -> impl Iterator<Item = (&str, &str)> {
    page.split("\n```").skip(usize::from(fenced)).step_by(2).map(|block| block.split_once('\n').unwrap_or((block, "")))
}

/// A page without its fenced blocks.
fn prose(page: &str) -> String {
    blocks(page, false).flat_map(|(first, rest)| [first, "\n", rest]).collect()
}

/// The anchors of a page's headings, as a code host derives them.
fn anchors(page: &str) -> BTreeSet<String> {
    let letters = |heading: &str| {
        let kept = heading.chars().filter(|letter| letter.is_alphanumeric() || " -_".contains(*letter));
        kept.collect::<String>().to_lowercase().replace(' ', "-")
    };
    let text = prose(page);
    let headings = text.lines().filter(|line| line.starts_with('#'));
    headings.map(|heading| letters(heading.trim_start_matches('#').trim())).collect()
}

#[test]
fn links_of_pages_lead_somewhere() {
    let all = pages(&["", "docs", "tests", "examples/gait", "examples/lecture", "examples/paper"]);
    for (path, page) in &all {
        for link in prose(page).split("](").skip(1).filter_map(|link| link.split(')').next()) {
            if link.starts_with("https://") {
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let file = if file.is_empty() { path.clone() } else { path.with_file_name(file) };
            let target = fs::canonicalize(&file).unwrap_or_else(|error| panic!("{}: {link}: {error}", path.display()));
            let known = || anchors(&all[&target]).contains(anchor);
            assert!(anchor.is_empty() || known(), "{}: {link} has no such heading", path.display());
        }
    }
}

/// Runs a bash script in `folder`, where `heelstrike` is the command under test.
fn shell(script: &str, folder: &Path) -> Run {
    let tool = Path::new(env!("CARGO_BIN_EXE_heelstrike")).parent().expect("a folder");
    let paths = env::split_paths(&env::var_os("PATH").unwrap_or_default()).collect::<Vec<_>>();
    let paths = env::join_paths([tool.to_owned()].into_iter().chain(paths)).expect("paths");
    let mut bash = assert_cmd::Command::new("bash");
    finished(bash.args(["-euc", script]).current_dir(folder).env("PATH", paths).env_remove("CLICOLOR_FORCE"))
}

/// Whether the printed lines match the shown ones, in which a line `...` stands for any number of lines.
fn are_shown(shown: &[&str], printed: &[&str]) -> bool {
    match shown.split_first() {
        None => printed.is_empty(),
        Some((&"...", later)) => (0..=printed.len()).any(|skipped| are_shown(later, &printed[skipped..])),
        Some((line, later)) => {
            printed.split_first().is_some_and(|(first, rest)| first.trim_end() == *line && are_shown(later, rest))
        }
    }
}

/// Runs the `sh` and `console` blocks of README and docs and the commands in their text, each page in a folder of its
/// own. Blocks that build or install are left to `.ci/run`.
#[test]
#[cfg(unix)]
fn commands_of_pages_print_what_is_shown() {
    for (path, page) in pages(&["", "docs"]) {
        let folder = PathBuf::from(place(path.file_stem().and_then(|name| name.to_str()).expect("a name")));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir(&folder).expect("a folder");
        for name in ["urdf", "examples", "tests"] {
            std::os::unix::fs::symlink(Path::new(ROOT).join(name), folder.join(name)).expect("a link");
        }
        for (language, block) in blocks(&page, true) {
            if language == "sh" && !block.contains("cargo ") && !block.contains("pip ") {
                shell(block, &folder).well();
            } else if language == "console" {
                for example in format!("\n{block}").split("\n$ ").skip(1) {
                    let (command, shown) = example.split_once('\n').unwrap_or((example, ""));
                    let printed = shell(&format!("{command} 2>&1"), &folder).stdout;
                    let lines: Vec<&str> = shown.lines().collect();
                    let same = are_shown(&lines, &printed.lines().collect::<Vec<_>>());
                    assert!(same, "{}\n$ {command}\n{printed}\nis shown as\n{shown}", path.display());
                }
            }
        }
        let prose = prose(&page).replace('\n', " ");
        let code = prose.split('`').skip(1).step_by(2);
        for command in code.filter(|code| code.starts_with("heelstrike ") && code.contains(" urdf/")) {
            shell(command, &folder).well();
        }
    }
}

#[test]
fn picture_of_readme_is_current() {
    let drawn = place("outcomes.svg");
    heelstrike(&["impact", WALKER, "examples/minimalistic.json", "--plot", &drawn]).well();
    let same = read(&drawn) == read("examples/outcomes.svg");
    assert!(same, "heelstrike impact {WALKER} examples/minimalistic.json --plot examples/outcomes.svg");
}

/// The names of all fields of a schema.
fn fields(schema: &Value) -> Vec<&str> {
    let own = schema["properties"].as_object().into_iter().flat_map(|fields| fields.keys().map(String::as_str));
    let parts: Box<dyn Iterator<Item = &Value>> = match schema {
        Value::Object(parts) => Box::new(parts.values()),
        Value::Array(parts) => Box::new(parts.iter()),
        _ => Box::new([].iter()),
    };
    own.chain(parts.flat_map(fields)).collect()
}

/// The name of a column in docs/formats.md, such as `mode_CONTACT` for `mode_left_foot`.
fn column(name: &str) -> String {
    let (kind, rest) = name.split_once('_').unwrap_or((name, ""));
    match kind {
        "mode" => "mode_CONTACT".to_owned(),
        "p" | "f" => format!("{kind}_CONTACT_{}", &name[name.len() - 1..]),
        "v" if rest.starts_with("after_") => "v_after_COORDINATE".to_owned(),
        "q" | "v" | "a" => format!("{kind}_COORDINATE"),
        _ => name.to_owned(),
    }
}

#[test]
fn formats_name_every_field_and_column() {
    let page = read("docs/formats.md");
    let code = page.split('`').skip(1).step_by(2);
    let words: BTreeSet<&str> = code.flat_map(|code| code.split(|c: char| !c.is_alphanumeric() && c != '_')).collect();
    for document in ["state", "result", "forces", "problem", "study", "sweep", "accuracy"] {
        let schema = parsed(&heelstrike(&["schema", document]).text());
        for name in fields(&schema) {
            assert!(words.contains(name), "{document}: {name}");
        }
    }
    let walk = ["batch", RAMONE, "examples/gait/ramone_walk.csv", "--friction", "0.6", "--refused", "ok"];
    for arguments in [
        &[&walk[..], &["--touchdowns", "--next"]].concat()[..],
        &[&walk[..], &["--forces"]].concat(),
        &["sweep", WALKER, "examples/paper/figure_7.json"],
    ] {
        let table = place("table.csv");
        heelstrike(&[arguments, &["-o", &table]].concat()).well();
        // The table also has a column for the study's parameter, alpha.
        for name in read(&table).lines().next().expect("a header").split(',').filter(|name| *name != "alpha") {
            assert!(words.contains(column(name).as_str()), "{arguments:?}: {name}");
        }
    }
}
