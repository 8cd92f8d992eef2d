//! Interactive pages: the files that `sweep` and `batch` write (here), how they behave in a browser (`live`), and the
//! live page of `web/build` (`web`). `browser` drives a browser.
//!
//! Without a Chromium the browser's tests print a note and pass; HEELSTRIKE_BROWSER names one that must be there.

mod browser;
mod live;
mod web;

use super::support::urdf;
use super::{BLOCK, RAMONE, WALKER, each, file, fs, heelstrike, heelstrike_reads, list, parsed, place, read, walker};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

const WALK: [&str; 5] = ["batch", RAMONE, "examples/gait/ramone_walk.csv", "--friction", "0.6"];

/// The largest size of a page with 400 samples of RAMone \[bytes\].
const LARGEST: usize = 3_000_000;

/// Runs a command that writes a page; returns the page and its path.
fn page(args: &[&str], stdin: &str, name: &str) -> (String, PathBuf) {
    let path = place(name);
    let run = heelstrike_reads(&[args, &["--plot", &path]].concat(), stdin);
    let page = fs::read_to_string(&path).unwrap_or_else(|_| panic!("{}", run.stderr));
    (page, path.into())
}

/// The JSON that a page embeds.
fn data(page: &str) -> Value {
    let (_, rest) = page.split_once(r#"<script type="application/json" id="data">"#).expect("data");
    let (data, _) = rest.split_once("</script>").expect("their end");
    parsed(data)
}

/// The parameter values at which an axis of the page stops.
fn axis(data: &Value, axis: usize) -> Vec<f64> {
    serde_json::from_value(data["axes"][axis]["values"].clone()).expect("numbers")
}

/// The minimalistic biped around its border at alpha = pi / 6, where its trailing foot stops sliding.
fn near_a_border() -> Value {
    walker(json!({"alpha": {"from": 0.5, "to": 0.55, "steps": 3}}))
}

/// [`near_a_border`] with the rate of turning as second parameter.
fn grid(samples: usize, rates: usize) -> Value {
    let mut grid = near_a_border();
    grid["parameters"]["alpha"]["steps"] = json!(samples);
    grid["parameters"]["rate"] = json!({"from": -2.0, "to": -1.0, "steps": rates});
    grid["state"]["velocity"]["base"]["pitch"] = json!("rate");
    grid
}

fn swept(robot: &str, study: &Value, name: &str) -> (String, PathBuf) {
    let study = file(&name.replace("html", "json"), study.to_string());
    page(&["sweep", robot, &study], "", name)
}

/// A name of robot, link and state that tries to end the page's script element.
const HOSTILE: &str = "</script><script>alert(1)</script><!--\u{202e}";
/// [`HOSTILE`] as the page shows it.
const SHOWN: &str = r"</script><script>alert(1)</script><!--\u{202e}";

fn hostile() -> (String, PathBuf) {
    let escaped = HOSTILE.replace('<', "&lt;").replace('>', "&gt;");
    let link = urdf::link(&escaped, 2.0, [0.0; 2], 1.0, &urdf::collision([0.0; 2], "sphere radius=\"0.5\""));
    let robot = file("hostile.urdf", format!("<robot name=\"{escaped}\">{link}</robot>"));
    let state =
        json!({"id": HOSTILE, "position": {"base": {"z": 0.5}}, "velocity": {"base": {"z": -1}}, "friction": 1});
    let states = format!("{state}\n{}\n", json!({"id": "{data}", "position": {"base": {"z": 0.5, "{program}": 1}}}));
    page(&["batch", &robot, "-"], &states, "hostile.html")
}

#[test]
fn the_data_of_a_small_study() {
    let (page, _) = swept(WALKER, &near_a_border(), "small.html");
    let mut data = data(&page);
    // Results next to the border depend on the last digits of its place, so the snapshot has three other samples.
    let samples = [0, 5, 8].map(|sample| data["frames"][sample].take());
    data["frames"] = json!(samples);
    data["axes"][0]["values"].take();
    // One line per entry.
    let listed = |value: &Value| match value {
        Value::Array(entries) => entries.iter().map(|entry| format!("\n  {entry}")).collect::<String>(),
        value => format!(" {value}"),
    };
    let lines = data.as_object().expect("an object").iter().map(|(name, value)| format!("{name}:{}\n", listed(value)));
    insta::assert_snapshot!("small", lines.collect::<String>());
}

/// Impulses have no bound near poles, and some stops of the page lie there.
#[test]
fn arrows_of_a_study_are_seen_beside_poles() {
    let (page, _) = page(&["sweep", WALKER, "examples/paper/figures_3_and_6.json"], "", "poles.html");
    let data = data(&page);
    let impulses = |frame: &Value| {
        let own = list(&frame["outcomes"]).iter().flat_map(|outcome| list(&outcome["impulse"]));
        own.flat_map(list).map(|entry| entry.as_f64().expect("a number").abs()).fold(0.0, f64::max)
    };
    let largest: Vec<f64> = list(&data["frames"]).iter().map(impulses).collect();
    let usual = data["scale"]["impulse"].as_f64().expect("a number");
    // An impulse of the usual size is an arrow as long as a quarter of the view.
    let seen = largest.iter().filter(|impulse| **impulse > 0.05 * usual).count();
    assert!(largest.iter().any(|impulse| *impulse > 100.0 * usual), "a pole: {usual} of {largest:?}");
    assert!(10 * seen > 9 * largest.len(), "{seen} of {} with {usual}", largest.len());
}

/// The five-bar leg at two speeds.
fn five_bar() -> (String, PathBuf) {
    let mut state = parsed(&read("examples/five_bar.json"));
    state["velocity"]["base"]["z"] = json!("fall");
    let study = json!({"parameters": {"fall": {"from": -1.0, "to": -0.5, "steps": 2}}, "state": state});
    swept("urdf/five_bar.urdf", &study, "five_bar.html")
}

#[test]
fn a_loops_impulse_is_on_the_link_that_it_pushes_up() {
    let data = data(&five_bar().0);
    let [link, impulse] = list(&data["frames"][0]["outcomes"][0]["loops"][0]) else { panic!("a link, its impulse") };
    // Text and JSON give the impulse on the left shank, (-0.116, -0.2555). The page gives its opposite on the right
    // shank.
    assert_eq!(data["texts"][link.as_u64().expect("a number") as usize], "right_shank");
    assert_eq!(impulse, &json!([0.11596, 0.25551]));
}

#[test]
fn pages_of_a_mirror_name_what_turns_in_it() {
    let study = file("mirror.json", near_a_border().to_string());
    let sweep = ["sweep", WALKER, &study];
    let [ahead, behind] =
        [&sweep[..], &[&sweep[..], &["--mirror"]].concat()].map(|args| data(&page(args, "", "mirror.html").0));
    let border = |data: &Value| data["regions"][0]["borders"][0][1].as_str().expect("words").to_owned();
    assert!(border(&ahead).contains("sliding backward") && border(&behind).contains("sliding forward"), "{behind}");
    let impulse = |data: &Value| data["frames"][0]["outcomes"][0]["impulse"][1][0].as_f64().expect("a number");
    assert_eq!(impulse(&ahead), -impulse(&behind));
}

#[test]
fn a_page_stops_at_samples_and_within_every_region() {
    let (page, _) = swept(WALKER, &near_a_border(), "stops.html");
    let data = data(&page);
    let stops = axis(&data, 0);
    let border = std::f64::consts::FRAC_PI_6;
    // Three samples, and for each of two regions both ends and the middle.
    assert_eq!(stops.len(), 9);
    assert!(stops.is_sorted());
    for sample in [0.5, 0.525, 0.55] {
        assert!(stops.contains(&sample), "{stops:?}");
    }
    let beside: Vec<f64> = stops.iter().map(|stop| stop - border).filter(|beside| beside.abs() < 1e-12).collect();
    assert!(matches!(beside[..], [below, above] if below < 0.0 && above > 0.0), "{beside:?}");
    assert_eq!(each(&data["frames"], "region"), [0, 0, 0, 0, 1, 1, 1, 1, 1]);
}

#[test]
fn nothing_is_loaded() {
    let (page, _) = swept(WALKER, &near_a_border(), "alone.html");
    assert!(page.contains(r#"content="default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'""#));
    let named = page.matches("://").count();
    let spaces = page.matches(r#""http://www.w3.org/2000/svg""#).count();
    assert_eq!(named, spaces, "every address is the name of SVG's space");
    for loading in ["src=", "url(http", "@import", "import(", "fetch(", "XMLHttpRequest", "eval(", "<link", "<base"] {
        assert!(!page.contains(loading), "{loading}");
    }
}

#[test]
fn names_stay_names() {
    let (page, _) = hostile();
    // One script element holds the data and one the program.
    assert_eq!((page.matches("<script").count(), page.matches("</script>").count()), (2, 2));
    assert!(!page.contains("<!--"));
    let data = data(&page);
    assert_eq!(data["title"], format!("{SHOWN}, state by state"));
    assert_eq!(data["frames"][0]["name"], format!("{SHOWN}, line 1"));
    assert!(!page.contains('\u{202e}'));
    // Placeholders within names are not filled in.
    assert_eq!(data["frames"][1]["name"], "{data}, line 2");
    assert!(data["texts"].to_string().contains("{program}"));
}

#[test]
fn four_hundred_samples_of_ramone_are_small() {
    let dense = parsed(&read("examples/paper/table_1.json").replace(r#""steps": 50"#, r#""steps": 400"#));
    let (page, _) = swept("urdf/ramone_paper.urdf", &dense, "dense.html");
    assert!(page.len() < LARGEST, "{} bytes", page.len());
    let data = data(&page);
    assert_eq!(list(&data["frames"]).len(), 400 + 3 * 7);
    assert_eq!(list(&data["parts"]).len(), 3, "bodies of one shape share it: torso, thigh, shank");
}

#[test]
fn a_grid_of_two_parameters_is_thinned_if_too_fine() {
    let study = |[samples, rates]: [usize; 2]| {
        let alpha = json!({"from": 0.5, "to": 0.55, "steps": samples});
        json!({"parameters": {"alpha": alpha, "rate": {"from": -2, "to": -1, "steps": rates}},
            "state": {"velocity": {"base": {"x": "alpha", "z": "rate"}}, "friction": 1}})
    };
    let [few, many] = [[4, 2], [72, 70]].map(|samples| data(&swept(BLOCK, &study(samples), "grid.html").0));
    assert_eq!((axis(&few, 0).len(), axis(&few, 1).len()), (4, 2));
    assert_eq!(list(&few["frames"]).len(), 8);
    // The longer axis is thinned and keeps its last sample.
    assert_eq!((axis(&many, 0).len(), axis(&many, 1).len()), (37, 70));
    assert_eq!((axis(&many, 0)[0], axis(&many, 0)[36]), (0.5, 0.55));
    assert_eq!(many["notes"][0], "this page stops at one of 2 samples of alpha");
}

#[test]
fn a_long_batch_is_thinned_evenly_with_a_note() {
    let state = |line: usize| format!("{}\n", json!({"id": line, "position": {"base": {"z": 3}}, "friction": 1}));
    let states: String = (1..=5001).map(state).collect();
    let (page, _) = page(&["batch", RAMONE, "-", "--brief"], &states, "long.html");
    let data = data(&page);
    assert_eq!(axis(&data, 0), (0..2501).map(|k| f64::from(2 * k + 1)).collect::<Vec<_>>());
    assert_eq!(data["notes"], json!(["this page shows one of every 2 of the 5001 states"]));
}

#[test]
fn a_batch_writes_the_same_results_beside_its_page() {
    let alone = heelstrike(&WALK).stdout;
    let path = place("same.html");
    let run = |threads| {
        let page = ["--threads", threads, "--plot", &path];
        assert_eq!(alone, heelstrike(&[&WALK[..], &page].concat()).stdout);
        read(&path)
    };
    assert_eq!(run("1"), run("4"));
}

#[test]
fn a_batch_draws_its_margins_as_svg() {
    let path = place("walk.svg");
    heelstrike(&[&WALK[..], &["--resting-speed", "1e-9", "--plot", &path]].concat()).well();
    insta::assert_snapshot!("walk", read(&path).replace("><", ">\n<"));
}

#[test]
fn a_page_of_nothing_is_refused() {
    let path = place("nothing.html");
    let stderr = heelstrike(&["batch", RAMONE, "-", "--plot", &path]).refusal(1);
    assert_eq!(stderr, "error: <stdin>: a state is missing\nhint: the input is empty\n");
    assert!(!Path::new(&path).exists());
}

#[test]
fn commands_without_pages_refuse_to_write_one() {
    let by_others = "interactive pages are written by `sweep` and `batch`";
    let other_ending = "an interactive page as .html";
    for (arguments, name, words) in [
        (&["impact", RAMONE, "examples/ramone.json"][..], "report.html", by_others),
        (&["inspect", RAMONE], "report.html", by_others),
        (&["accuracy", "--case", "massless", "--time", "0"], "report.html", by_others),
        (&["sweep", "urdf/ramone_paper.urdf", "examples/paper/table_1.json"], "report.htm", other_ending),
        (&["batch", RAMONE, "-"], "report.htm", other_ending),
    ] {
        heelstrike(&[arguments, &["--plot", name]].concat()).refusal_with(2, words);
    }
}

/// The block with Painlevé's paradoxes at two rates of turning: one has no outcome, the other has two.
#[test]
fn pages_and_pictures_of_forces_name_them() {
    let study = json!({"question": "forces", "parameters": {"omega": {"from": 0, "to": 4, "steps": 2}},
        "state": {"velocity": {"base": {"x": 1, "pitch": "omega"}}, "friction": 3}});
    let (page, _) = swept("urdf/block.urdf", &study, "forces.html");
    assert!(page.contains("acceleration [m/s\u{b2}]") && page.contains("force [N]"));
    let data = data(&page);
    let expected = json!({"given": ["force", "N"], "taken": ["acceleration", "m/s\u{b2}"], "moving": "velocity",
        "lost": "W lost"});
    assert_eq!(data["wording"], expected);
    let (frames, texts) = (list(&data["frames"]), &data["texts"]);
    let [first, last] = [&frames[0], &frames[frames.len() - 1]];
    let sentence = |frame: &Value| texts[frame["sentence"].as_u64().expect("a number") as usize].clone();
    assert_eq!(sentence(first), "No forces are consistent: velocities jump");
    assert_eq!(sentence(last), "Two outcomes are equally valid.");
    // The block slides at 1 m/s against a force of 18.57 N.
    let lost: Vec<&Value> = list(&last["outcomes"]).iter().map(|own| &own["energy_loss"]).collect();
    assert_eq!(lost, [&json!(0.0), &json!(18.57)]);

    let state = json!({"velocity": {"base": {"x": 1, "pitch": 4}}, "friction": 3}).to_string();
    let (svg, _) = self::page(&["forces", "urdf/block.urdf", "-"], &state, "forces.svg");
    for key in ["force of the ground: 2 N", "acceleration: 10 m/s\u{b2}", "velocity, toward the contact: 0.2 m/s"] {
        assert!(svg.contains(key), "{key}");
    }
    // The velocity is along the ground, and its arrow is drawn above it.
    let height = |sign: &str, of: &str| {
        let line = svg.split("><").find(|line| line.contains(sign)).expect(sign);
        let (_, rest) = line.split_once(of).expect(of);
        rest.split([' ', '"', 'L'])
            .nth(if of == "M" { 1 } else { 0 })
            .and_then(|y| y.parse::<f64>().ok())
            .expect("a height")
    };
    let above = height(r##"r="3" fill="#000000""##, "cy=\"") - height(r#"stroke-dasharray="8 4""#, "M");
    assert!(above > 8.0, "{above}");
}
