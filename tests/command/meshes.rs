//! Mesh files through the command: how it finds them by name, its messages about missing, broken or hostile files, and
//! the feet that result. Unit tests next to their code cover mesh readers and hulls.

use super::support::urdf;
use super::{command, each, finished, fs, heelstrike, list, place};
use assert_cmd::Command;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A folder for the running test, removed if an earlier run left it.
fn folder() -> PathBuf {
    let folder = PathBuf::from(place("meshes"));
    let _ = fs::remove_dir_all(&folder);
    folder
}

fn write(path: &Path, text: impl AsRef<[u8]>) {
    fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    fs::write(path, text).expect("a file");
}

/// A robot of one link with this element inside `<collision>`.
fn robot(collision: &str) -> String {
    urdf::robot(&[urdf::link("foot", 2.0, [0.0; 2], 0.5, &format!("<collision>{collision}</collision>"))])
}

fn mesh(name: &str) -> String {
    robot(&format!("<geometry><mesh filename=\"{name}\"/></geometry>"))
}

fn inspecting() -> Command {
    let mut command = command();
    command.arg("inspect");
    command
}

#[track_caller]
fn inspect(command: &mut Command, urdf: &Path) -> Value {
    finished(command.args(["--format", "json"]).arg(urdf)).well().line()
}

/// The corners of the robot's only foot, or the reason why it has none.
#[track_caller]
fn foot(command: &mut Command, urdf: &Path) -> Result<Value, String> {
    let inspection = inspect(command, urdf);
    match list(&inspection["feet"]) {
        [] => Err(inspection["left_out"][0]["why"].as_str().expect("a reason").to_owned()),
        [foot] => Ok(foot["corners"].clone()),
        _ => panic!("{inspection}"),
    }
}

/// A box with half sizes 0.1, 0.05 and 0.02 m, as OBJ.
fn sole() -> String {
    let sign = |at: usize, bit: usize| if at >> bit & 1 == 0 { "-" } else { "" };
    let vertex = |at: usize| format!("v {}0.1 {}0.05 {}0.02\n", sign(at, 0), sign(at, 1), sign(at, 2));
    let vertices: String = (0..8).map(vertex).collect();
    format!("{vertices}f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\n")
}

#[test]
fn a_mesh_of_a_box_strikes_as_the_box_does() {
    let folder = folder();
    write(&folder.join("sole.obj"), sole());
    write(&folder.join("mesh.urdf"), mesh("sole.obj"));
    write(&folder.join("box.urdf"), robot("<geometry><box size=\"0.2 0.1 0.04\"/></geometry>"));
    let state = r#"{"position": {"base": {"z": 0.02}}, "velocity": {"base": {"x": 0.3, "z": -1, "pitch": 0.5}}, "friction": 0.6}"#;
    let [of_mesh, of_box] = ["mesh.urdf", "box.urdf"].map(|name| {
        let mut command = command();
        finished(command.arg("impact").arg(folder.join(name)).args(["-", "--format", "json"]).write_stdin(state)).stdout
    });
    assert!(of_box.contains("\"verdict\":\"unique\"") && of_box.contains("foot/1"), "{of_box}");
    assert_eq!(of_mesh, of_box);
}

#[test]
fn a_mesh_in_meters_that_is_scaled_as_in_millimeters_is_noted() {
    let folder = folder();
    write(&folder.join("sole.obj"), sole());
    let urdf = folder.join("r.urdf");
    let scaled = |scale: &str| {
        write(&urdf, robot(&format!("<geometry><mesh filename=\"sole.obj\" scale=\"{scale}\"/></geometry>")));
        let inspection = inspect(&mut inspecting(), &urdf);
        list(&inspection["cautions"]).iter().find(|own| own.to_string().contains("a mesh of")).cloned()
    };
    let words = "a mesh of foot spans 2e-4 m: lengths are in meters; a mesh in meters needs no scale";
    assert_eq!(scaled("0.001 0.001 0.001"), Some(words.into()));
    assert_eq!(scaled("1 1 1"), None);
}

#[test]
fn packages_are_found_by_option_variable_and_folder() {
    let folder = folder();
    let urdf = folder.join("robots/deep/r.urdf");
    write(&urdf, mesh("package://a_description/meshes/sole.obj"));
    let missing = |folders: &str| {
        let what = "neither package a_description nor this file is in ";
        Err(format!("{what}{folders}a folder above the URDF file: name its folder by `package_path`"))
    };
    assert_eq!(foot(&mut inspecting(), &urdf), missing(""));

    let gone = heelstrike(&["inspect", &urdf.to_string_lossy(), "--package-path", "no/such/folder"]);
    gone.refusal_with(2, "there is no folder no/such/folder");

    let elsewhere = folder.join("elsewhere");
    write(&elsewhere.join("share/a_description/meshes/sole.obj"), sole());
    let found = |command: &mut Command| assert!(foot(command, &urdf).is_ok());
    let share = elsewhere.join("share");
    found(inspecting().arg("--package-path").arg(&share));
    found(inspecting().arg("--package-path").arg(&folder).arg("--package-path").arg(&share));
    found(inspecting().arg("--package-path").arg(share.join("a_description")));
    // The package's own folder with another name.
    let renamed = share.join("renamed");
    fs::create_dir(&renamed).expect("a folder");
    let looked = missing(&format!("{} or ", renamed.display()));
    assert_eq!(foot(inspecting().arg("--package-path").arg(&renamed), &urdf), looked);
    write(&renamed.join("meshes/sole.obj"), sole());
    found(inspecting().arg("--package-path").arg(&renamed));
    found(inspecting().env("ROS_PACKAGE_PATH", &share));
    found(inspecting().env("AMENT_PREFIX_PATH", &elsewhere));

    // First a folder with the package's name but without the file. Then the file, in a folder of another name whose
    // manifest gives the package's name.
    fs::create_dir(folder.join("robots/a_description")).expect("a folder");
    assert_eq!(foot(&mut inspecting(), &urdf), Err("no such file in package a_description".to_owned()));
    write(&folder.join("robots/package.xml"), "<package><name> a_description </name></package>");
    fs::remove_dir(folder.join("robots/a_description")).expect("removed");
    write(&folder.join("robots/meshes/sole.obj"), sole());
    found(&mut inspecting());
    // A folder above the URDF file that has the file, without a manifest, is a guess.
    let guesses = |command: &mut Command| {
        let inspection = inspect(command, &urdf);
        let cautions = list(&inspection["cautions"]).iter().filter_map(Value::as_str).map(str::to_owned);
        cautions.filter(|caution| caution.contains("guessed")).collect::<Vec<_>>()
    };
    assert!(guesses(&mut inspecting()).is_empty());
    fs::remove_file(folder.join("robots/package.xml")).expect("removed");
    found(&mut inspecting());
    let robots = folder.join("robots").canonicalize().expect("a folder");
    let guess = format!(
        "packages of meshes whose folder is guessed by the path of a file: a_description in {}; if it is another, name \
         the right one by `package_path`",
        robots.display()
    );
    assert_eq!(guesses(&mut inspecting()), [guess]);
    assert!(guesses(inspecting().arg("--package-path").arg(&robots)).is_empty());
}

#[test]
fn names_of_every_kind_lead_to_the_file() {
    let folder = folder();
    write(&folder.join("pack/meshes/my sole.obj"), sole());
    write(&folder.join("pack/meshes/100%20.OBJ"), sole());
    let urdf = folder.join("pack/urdf/r.urdf");
    let absolute = folder.join("pack/meshes/my sole.obj");
    let absolute = absolute.to_str().expect("UTF-8");
    for name in [
        "../meshes/my sole.obj",
        "..\\meshes\\my sole.obj",
        "../meshes/my%20sole.obj",
        "../meshes/100%20.OBJ",
        "package://pack/meshes/my%20sole.obj",
        "package://pack//meshes/../meshes/my sole.obj",
        "model://pack/meshes/my sole.obj",
        "package:///pack/meshes/my sole.obj",
        "package:///other/meshes/my sole.obj",
        absolute,
        &format!("file://{absolute}"),
        &format!("file://{}", absolute.replace(' ', "%20")),
    ] {
        write(&urdf, mesh(name));
        let corners = json!([[-0.1, -0.02], [0.1, -0.02], [0.1, 0.02], [-0.1, 0.02]]);
        assert_eq!(foot(&mut inspecting(), &urdf), Ok(corners), "{name}");
    }
    for (name, why) in [
        ("../meshes/sole.obj", "no such file"),
        ("https://example.org/sole.obj", "no file of this machine"),
        ("../meshes", "no such file"),
        ("/dev/zero", "no such file"),
        ("package://pack/", "no such file in package pack"),
        ("package:///pack/gone.stl", "no such file in package pack"),
    ] {
        write(&urdf, mesh(name));
        assert_eq!(foot(&mut inspecting(), &urdf), Err(why.to_owned()), "{name}");
    }
}

#[test]
fn a_path_that_leaves_its_package_is_left_out() {
    let urdf = folder().join("r.urdf");
    for name in [
        "package://x/../../etc/passwd",
        "package://x/meshes/../../y.stl",
        "package://x\\..\\y.stl",
        "package://x/%2e%2E/y.stl",
        "package://../etc/y.stl",
    ] {
        write(&urdf, mesh(name));
        let why = "its name leaves its package, as no name may";
        assert_eq!(foot(&mut inspecting(), &urdf), Err(why.to_owned()), "{name}");
    }
}

#[test]
fn missing_mesh_is_named_by_impact_too() {
    let urdf = folder().join("r.urdf");
    write(&urdf, mesh("package://gone/sole.stl"));
    let mut impact = command();
    let run = finished(impact.arg("impact").arg(&urdf).args(["-", "--friction", "1"]).write_stdin("{}")).well();
    let words = "note: 1 collision mesh is left out, so that nothing touches there (package://gone/sole.stl of foot: \
                 neither package gone nor this file is in a folder above the URDF file: name its folder by \
                 --package-path): give the file, or name a foot by --contact LINK:X,Y,Z";
    assert!(run.stderr.contains(words), "{}", run.stderr);
}

#[test]
fn meshes_that_cannot_be_read_are_left_out() {
    let folder = folder();
    let urdf = folder.join("r.urdf");
    for (name, bytes, why) in [
        ("nan.obj", &b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"[..], "has the coordinate NaN"),
        ("huge.obj", b"v 0 0 1e308\nv 1e308 0 0\nv -1e308 1 0\nf 1 2 3\n", "not distinct in f64"),
        ("short.stl", &[b' '; 100], "cannot be read"),
        ("empty.dae", b"", "cannot be read"),
        ("what.bin", b"what", "STL, OBJ or DAE"),
        ("big.obj", &vec![b'\n'; (16 << 20) + 1], "more than 16 MiB of OBJ text"),
        ("bigger.stl", &vec![0; (64 << 20) + 1], "more than 64 MiB"),
    ] {
        write(&folder.join(name), bytes);
        write(&urdf, mesh(name));
        let reason = foot(&mut inspecting(), &urdf).expect_err(name);
        assert!(reason.contains(why), "{name}: {reason}");
    }
}

#[test]
fn the_feet_of_solo_are_the_hulls_of_their_meshes() {
    let inspection = inspect(
        inspecting().args(["--package-path", "tests/data/robots/solo8/packages"]),
        Path::new("tests/data/robots/solo8/solo.urdf"),
    );
    assert_eq!(each(&inspection["feet"], "link"), ["FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT"]);
    for foot in list(&inspection["feet"]) {
        // The mesh is a prism of 106 sides about (0, -0.16). Its corners lie on a circle of 16 mm, to less than the
        // bulge of a side, 16 mm (1 - cos(pi / 106)) = 7e-6 m.
        assert_eq!(foot["mesh"], "solo_foot.obj");
        let corners = list(&foot["corners"]);
        assert_eq!(corners.len(), 106);
        for corner in corners {
            let [x, z] = [0, 1].map(|axis| corner[axis].as_f64().expect("a number"));
            assert!((x.hypot(z + 0.16) - 0.016).abs() < 1e-6, "{corner}");
        }
    }
    let mut reasons = each(&inspection["left_out"], "why");
    reasons.retain(|why| why == "no such file in package example-robot-data");
    assert_eq!(reasons.len(), 9);
}
