//! How a page behaves: keys, sliders and clicks move the robot, the cursors and the answers.

use super::browser::found;
use super::{RAMONE, SHOWN, WALK, WALKER, data, each, file, five_bar, grid, hostile, list, near_a_border};
use super::{page, parsed, read, swept};
use crate::result;
use serde_json::{Value, json};

const WINDOW: (u32, u32) = (1280, 800);

/// The entries of a list as numbers, whether they are numbers or text of the page.
fn numbers(list: &Value) -> Vec<f64> {
    let number = |entry: &Value| match entry {
        // The page writes the minus sign U+2212.
        Value::String(text) => text.replace('−', "-").parse().expect("a number"),
        entry => entry.as_f64().expect("a number"),
    };
    self::list(list).iter().map(number).collect()
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

#[test]
fn keys_and_slider_move_the_robot_and_the_cursor() {
    let (_, path) = swept(WALKER, &near_a_border(), "keys.html");
    let Some(found) = found(&path, WINDOW, include_str!("scripts/keys.js")) else { return };
    let steps = &found["steps"];
    let step = |name: &str, of: &str| steps[name][of].as_f64().expect("a number");
    let stops =
        [("start", 0.0), ("right", 1.0), ("left", 0.0), ("before", 0.0), ("end", 8.0), ("behind", 8.0), ("slide", 2.0)];
    for (name, stop) in stops {
        assert_eq!(step(name, "stop"), stop, "{name}");
    }
    assert_eq!((step("home", "alpha"), step("end", "alpha")), (0.5, 0.55));
    // The page opens in the middle of the longer region; its buttons and strip act as the keys do.
    assert_eq!((&found["opened"]["stop"], &found["opened"]["badge"]), (&json!(6), &json!("B")));
    assert_eq!((&found["clicked"], &found["struck"]), (&json!([4, 5, 4, 3]), &json!(6)));
    let border = std::f64::consts::FRAC_PI_6;
    assert!(0.0 < step("border", "alpha") - border && step("border", "alpha") - border < 1e-12);
    assert!(0.0 < border - step("back", "alpha") && border - step("back", "alpha") < 1e-12);
    assert_eq!((&steps["back"]["badge"], &steps["border"]["badge"]), (&json!("A"), &json!("B")));
    let words = steps["border"]["told"].as_str().expect("words");
    assert!(words.ends_with(", region B, Exactly one outcome."), "{words}");
    // Spreading legs lower the hip, so that its y on the screen increases.
    let hip = |name: &str| steps[name]["hip"].as_str().and_then(|y| y.parse::<f64>().ok()).expect("a number");
    assert!(hip("start") < hip("slide") && hip("slide") < hip("end"));
    assert_eq!(hip("start"), hip("home"));

    // Region A spans the first sample to the border: its shading ends where the cursors of these stops are.
    let regions: Vec<Vec<f64>> = serde_json::from_value(found["regions"].clone()).expect("numbers");
    for (name, side) in [("start", 0), ("back", 1), ("border", 1)] {
        let cursors = numbers(&steps[name]["cursors"]);
        assert!(cursors.len() >= 2, "a cursor in each panel");
        for cursor in cursors {
            assert!(close(cursor, regions[0][side], 0.6), "{name}: {cursor}, {regions:?}");
        }
    }
}

#[test]
fn outcomes_are_those_of_the_tool() {
    let sweep = ["sweep", WALKER, "examples/paper/figures_3_and_6.json"];
    let (_, path) = page(&sweep, "", "outcomes.html");
    let sample = &result(&sweep, "")["samples"][45];
    let outcomes = list(&sample["result"]["outcomes"]);
    assert_eq!(outcomes.len(), 3);
    let script = format!("const alpha = {};{}", sample["alpha"], include_str!("scripts/outcomes.js"));
    let Some(found) = found(&path, WINDOW, &script) else { return };
    assert_eq!(found["alpha"], sample["alpha"]);
    assert_eq!(found["sentence"], "DThree outcomes are equally valid. Proven.");
    let shown = list(&found["everything"]);
    assert_eq!(shown.len(), 3);
    let slides = ["slides forward", "slides backward"];
    let verbs = json!({"separate": "lifts off", "stick": "sticks", "slide+": slides[0], "slide-": slides[1]});
    for (outcome, shown) in outcomes.iter().zip(shown) {
        let words = shown["words"].as_str().expect("words");
        for (contact, mode) in ["left_leg", "right_leg"].iter().zip(list(&outcome["modes"])) {
            let verb = verbs[mode.as_str().expect("a mode")].as_str().expect("a verb");
            assert!(words.contains(&format!("{contact} {verb}")), "{words}, {outcome}");
        }
        let (_, margin) = words.split_once("margin ").expect("a margin");
        let margin: f64 = margin.split(',').next().and_then(|margin| margin.parse().ok()).expect("a number");
        assert!(close(margin, outcome["margin"].as_f64().expect("a number"), 1e-3 * margin));
        let index = if outcome["index"] == 1 { "index +1" } else { "index −1" };
        assert!(words.contains(index), "{words}");
        for contact in 0..2 {
            let row = numbers(&shown["numbers"][contact]);
            let given = [numbers(&outcome["impulse"][contact]), numbers(&outcome["velocity_after"][contact])].concat();
            for (shown, given) in row.iter().zip(given) {
                assert!(close(*shown, given, 1e-3 * given.abs()), "{row:?} {given:?}");
            }
        }
    }
    let pressed = ["everything", "second", "none", "third"].map(|step| each(&found[step], "pressed"));
    // The key 9 selects nothing, because there is no ninth outcome.
    let [no, yes] = ["false", "true"];
    assert_eq!(pressed, [[no, no, no], [no, yes, no], [no, no, no], [no, no, yes]]);
    // The selected outcome is drawn last.
    assert_eq!(found["effects"], json!(["effect faded", "effect faded", "effect"]));
    assert!(found["status"].as_str().expect("a text").contains("3: left_leg slides forward, right_leg sticks"));
}

#[test]
fn a_map_is_walked_in_both_directions() {
    let (_, path) = swept(WALKER, &grid(3, 5), "map.html");
    let Some(found) = found(&path, WINDOW, include_str!("scripts/map.js")) else { return };
    let pair = |name: &str| (found[name][0].as_f64(), found[name][1].as_f64());
    assert_eq!(pair("start"), (Some(0.5), Some(-2.0)));
    assert_eq!(pair("up"), (Some(0.5), Some(-1.75)));
    assert_eq!(pair("beyond"), (Some(0.5), Some(-1.75)), "the region on the other side of the border");
    assert_eq!(pair("last"), (Some(0.55), Some(-1.0)));
    assert_eq!(pair("clicked"), (Some(0.525), Some(-1.5)));
    assert_eq!(pair("slid"), (Some(0.525), Some(-2.0)));
    assert_eq!(pair("held"), (Some(0.525), Some(-1.75)));
    assert_ne!(found["start"][2], found["last"][2], "two regions");
    let at = |name: &str, axis: usize| found[name][3 + axis].as_f64().expect("a number");
    assert!(at("last", 0) > at("start", 0) && at("last", 1) < at("start", 1), "the second parameter goes up");
    assert!(close(at("clicked", 0), 0.5 * (at("start", 0) + at("last", 0)), 0.6));
    assert!(close(at("up", 1), at("start", 1) + 0.25 * (at("last", 1) - at("start", 1)), 0.6));
}

#[test]
fn a_gait_is_walked_from_impact_to_impact() {
    let (_, path) = page(&[&WALK[..], &["--resting-speed", "1e-9"]].concat(), "", "walk.html");
    let Some(found) = found(&path, WINDOW, include_str!("scripts/batch.js")) else { return };
    assert_eq!(found["list"][2]["name"], "gait/050, line 52");
    assert_eq!(found["list"][2]["badge"], "unique");
    let words = found["list"][2]["words"].as_str().expect("words");
    assert!(words.contains("left_foot lifts off, right_foot sticks") && words.contains("margin 0.517"), "{words}");
    assert_eq!(found["list"][1]["badge"], "no impact");
    assert_eq!(found["end"]["name"], "gait/101, line 103");
    assert!(close(found["end"]["time"].as_f64().expect("a time"), 0.7624, 1e-4), "{}", found["end"]);
}

#[test]
fn a_single_state_has_the_whole_strip() {
    let state = parsed(&read("examples/ramone.json")).to_string();
    let (page, path) = page(&["batch", RAMONE, "-"], &state, "single.html");
    // The band of the state in both panels, and its entry in the key.
    assert_eq!(page.matches("fill=\"#eaf3fb\"").count(), 3, "{page}");
    let script = "found({ widths: all('.track span').map((part) => part.style.width) });";
    let Some(found) = found(&path, WINDOW, script) else { return };
    assert_eq!(found["widths"], json!(["100%"]));
}

#[test]
fn what_is_refused_says_why() {
    let height = json!({
        "parameters": {"z": {"from": 0.3, "to": 0.6, "steps": 4}},
        "state": {"position": {"base": {"z": "z"}}, "velocity": {"base": {"z": -1}}, "friction": 0.5}
    });
    let study = file("refused.json", height.to_string());
    let args = ["sweep", "urdf/ramone.urdf", &study, "--contact-tolerance", "0.01"];
    let (_, path) = page(&args, "", "refused.html");
    let Some(found) = found(&path, WINDOW, include_str!("scripts/refused.js")) else { return };
    let refused = &found["refused"];
    assert_eq!((&refused["scene"], &refused["bodies"]), (&json!("This state is refused."), &json!(0)));
    let sentence = refused["sentence"].as_str().expect("a sentence");
    assert!(sentence.starts_with("ARefused: link \"left_foot\" is "), "{sentence}");
    assert!(sentence.contains("hint: raise the base"), "{sentence}");
    assert_eq!(found["answered"]["bodies"], 5);
}

#[test]
fn hostile_names_are_shown_and_not_run() {
    let (page, path) = hostile();
    let script = r##"found({ heading: text("h1"), title: document.title, name: text(".name"), words: text("th.outcome"), labels: all("#scene text").map((label) => label.textContent), scripts: all("script").length });"##;
    let Some(found) = found(&path, WINDOW, script) else { return };
    let title = data(&page)["title"].clone();
    assert_eq!((&found["heading"], &found["title"]), (&title, &title));
    assert_eq!(found["name"], format!("{SHOWN}, line 1"));
    assert_eq!(found["labels"], json!([SHOWN]));
    assert!(found["words"].as_str().expect("words").contains(&format!("{SHOWN} sticks")));
    // Two scripts of the page and two of the test.
    assert_eq!(found["scripts"], 4);
}

#[test]
fn a_velocity_along_an_impulse_is_drawn_aside() {
    let Some(found) = found(&five_bar().1, WINDOW, include_str!("scripts/arrows.js")) else { return };
    assert_eq!(found["names"], json!(["right_shank", "left_shank"]));
    // The head of the velocity arrow is next to the contact, not on it; the loop's impulse points up.
    let [aside, down] = [&found["aside"], &found["down"]].map(|way| way.as_f64().expect("a number"));
    assert!(close(aside, 12.0, 0.01) && close(down, 0.0, 6.0), "{found}");
    assert_eq!(found["up"], json!(true));
}

#[test]
fn a_slide_without_an_arrow_has_its_direction() {
    let state = parsed(&read("examples/ramone.json")).to_string();
    let (_, path) = page(&["batch", RAMONE, "-"], &state, "small_slide.html");
    let script = r##"found({ names: all("#scene text").map((name) => name.textContent) });"##;
    let Some(found) = found(&path, WINDOW, script) else { return };
    assert_eq!(found["names"], json!(["right_foot", "left_foot \u{2192}"]));
}

#[test]
fn neighboring_times_are_told_apart() {
    let table: String =
        ["time,q_base_z,v_base_z", "1700000000,0.9,0", "1700000000.25,0.9,0", "1700000000.5,0.9,0"].join("\n");
    let (_, path) = page(&["batch", RAMONE, &file("times.csv", table)], "", "times.html");
    let script = r##"press("Home", "ArrowRight"); found({ time: text("output") });"##;
    let Some(found) = found(&path, WINDOW, script) else { return };
    assert_eq!(found["time"], "1700000000.25");
}

#[test]
fn a_platform_ends() {
    let state = json!({"place": "lowest", "ground": {"profile": [[-0.3, 0], [0.1, 0]]}}).to_string();
    let (_, path) = page(&["batch", RAMONE, "-", "--friction", "0.6"], &state, "platform.html");
    let script = r##"const ends = one(".surface").getAttribute("points").split(" ").map((point) => Number(point.split(",")[0]));
        found({ ends, width: one("#scene").clientWidth });"##;
    let Some(found) = found(&path, WINDOW, script) else { return };
    let (ends, width) = (numbers(&found["ends"]), found["width"].as_f64().expect("a width"));
    assert!(ends.len() == 2 && ends.iter().all(|x| (0.0..width).contains(x)), "{ends:?} within {width}");
}

#[test]
fn pages_fit_into_narrow_and_wide_windows() {
    let (_, path) = page(&["sweep", "urdf/ramone_paper.urdf", "examples/paper/table_1.json"], "", "fits.html");
    let script = include_str!("scripts/fits.js");
    for window in [(390, 844), (1280, 800)] {
        let Some(found) = found(&path, window, script) else { return };
        assert_eq!(found["inside"], json!([true, true, true, true, true]), "{window:?}");
        assert!(found["width"].as_f64() <= found["window"].as_f64(), "{found}");
    }
}
