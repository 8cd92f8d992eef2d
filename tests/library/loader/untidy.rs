//! Files that break a rule of XML, of URDF or of physics, and are read all the same.

use super::*;

/// A massive link.
const LINK: &str = "<link name=\"a\"><inertial><mass value=\"1\"/></inertial></link>";

#[test]
fn a_misspelt_or_late_declaration_is_passed_over() {
    for declaration in [
        "<?xml verison=\"1.0\"?>",
        "<?xml version=\"1.0\" encoding=\"utf-8\">",
        "<?xml version='1.0' encoding='latin-9' standalone=perhaps?>",
        "\n\n<?xml version=\"1.0\"?>",
        "<!-- made by hand -->\n<?xml version=\"1.0\"?>\n<?xml-model href=\"x\"?>",
        "\u{feff}<?xml version=\"1.1\"?>",
    ] {
        let robot = load(&format!("{declaration}\r\n<robot>{LINK}</robot>"));
        assert_eq!(robot.links().len(), 1, "{declaration}");
    }
    // Declaring macros is not using them.
    let declared = "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\">";
    assert_eq!(load(&format!("{declared}{LINK}</robot>")).links().len(), 1);
}

#[test]
fn undeclared_prefixes_are_listed_and_passed_over() {
    let text = format!(
        "<robot name=\"r\">\n{LINK}<sensor:camera name=\"c\"><sensor:image/></sensor:camera><controller:x/>\n\
         <link name=\"b\" drake:ignore=\"true\"/></robot>"
    );
    let refused = Robot::from_urdf(&text).expect_err("two roots");
    // The place is that of the file.
    assert_eq!(refused.to_string(), "3:1: link \"b\": links \"a\" and \"b\" are both roots");
    let robot = load(&text.replace("<link name=\"b\" drake:ignore=\"true\"/>", ""));
    let listed = |tag: &str| left_out(&format!("<{tag}> in <robot>"), "no part of the robot's mechanics");
    assert_eq!(robot.left_out(), [left_out("link \"a\"", POINT), listed("camera"), listed("x")]);
}

const POINT: &str = "its <inertial> has no <inertia>: taken as a point mass";

#[test]
fn an_inertia_that_no_body_has_is_listed() {
    let link = |ixx: f64, iyy: f64, izz: f64| {
        robot(&format!(
            "<link name=\"a\"><inertial><mass value=\"1\"/><inertia ixx=\"{ixx}\" iyy=\"{iyy}\" izz=\"{izz}\"/></inertial></link>"
        ))
    };
    let why = "no body can have its inertia: the moment about the plane's normal is taken as it is, the rest left out";
    for (ixx, iyy, izz) in [(0.0, 0.5, 0.0), (-1.0, 0.5, 0.5), (0.1, 0.5, 0.1)] {
        let robot = load(&link(ixx, iyy, izz));
        assert_eq!((robot.bodies()[0].moment, robot.left_out()), (iyy, &[left_out("link \"a\"", why)][..]));
    }
    // A point mass is a body.
    assert_eq!(load(&link(0.0, 0.0, 0.0)).left_out(), []);
}

#[test]
fn foreign_elements_at_a_shape_are_passed_over() {
    let geometry = |inside: &str| {
        let link = LINK.replace("</link>", &format!("<collision><geometry>{inside}</geometry></collision></link>"));
        Robot::from_urdf(&format!("<robot name=\"r\">{link}</robot>"))
    };
    let shapes = |inside: &str| geometry(inside).expect("a robot").links()[0].shapes.len();
    assert_eq!(shapes("<drake:declare_convex/><sphere radius=\"1\"/>"), 1);
    assert_eq!(shapes("<sphere radius=\"1\"/><drake:declare_convex/>"), 1);
    assert_eq!(shapes("<drake:capsule radius=\"1\" length=\"2\"/>"), 1);
    assert!(geometry("<sphere radius=\"1\"/><sphere radius=\"2\"/>").is_err());
}

#[test]
fn moment_that_is_negative_by_rounding_is_zero() {
    let link = |iyy: f64| {
        let inertia = format!("<inertia ixx=\"1e-3\" iyy=\"{iyy:e}\" izz=\"1e-3\"/>");
        Robot::from_urdf(&robot(&format!("<link name=\"a\"><inertial><mass value=\"1\"/>{inertia}</inertial></link>")))
    };
    let robot = link(-5e-20).expect("a robot");
    assert_eq!(robot.bodies()[0].moment, 0.0);
    let why = "its moment about the plane's normal is -5e-20 kg m^2, which is rounding: taken as 0";
    assert_eq!(robot.left_out(), [left_out("link \"a\"", why)]);
    assert!(link(-5e-10).is_err());
}

#[test]
fn hyphens_in_a_comment_are_named_with_their_place() {
    let text = format!("<robot>\n<!-- a - comment -->\n{LINK}<!-- the -- second -->\n</robot>");
    let error = Robot::from_urdf(&text).expect_err("no XML");
    let column = LINK.len() + 10;
    assert_eq!(error.to_string(), format!("3:{column}: a comment holds --, which XML does not allow"));
    assert_eq!(error.remedy(), Some("remove one of the hyphens, or the comment"));
}

#[test]
fn doubtful_inertias_and_angles_are_noted() {
    let shape = urdf::collision([0.0, -0.5], "box size=\"0.1 0.1 0.9\"");
    let good = urdf::robot(&[link("a", 3.0, [0.0; 2], 0.05, &shape)]);
    let replaced = |from: &str, to: &str| {
        assert!(good.contains(from), "{good}");
        load(&good.replace(from, to))
    };
    let (mass, inertia) = ("mass value=\"3\"", "<inertia ixx=\"0.05\" iyy=\"0.05\" izz=\"0.05\"/>");
    let drawn = "<origin xyz=\"0 0 -0.5\"/><geometry>";
    for (from, to, words) in [
        (inertia, "", "with a mass but no <inertia>, and so a point mass: a; give its moments"),
        (mass, "mass value=\"0.001\"", "with an inertia that needs a part far beyond the robot's size: a; "),
        (
            inertia,
            &inertia.replace("0.05", "1e-9"),
            "with more mass than the densest metal has in a ball of this inertia: a; ",
        ),
        (
            inertia,
            "<inertia ixx=\"0\" iyy=\"1e-9\" izz=\"0\"/>",
            "with more mass than the densest metal has in a ball of this inertia: a; ",
        ),
        ("izz=\"0.05\"", "izz=\"0.2\"", "with an inertia that no body has, one moment being more than"),
        (drawn, "<origin rpy=\"0 90 0\"/><geometry>", "the rpy of a, \"0 90 0\", is more than a turn: angles are"),
    ] {
        let robot = replaced(from, to);
        assert!(only_caution(&robot).starts_with(words), "{}", only_caution(&robot));
    }
    // Without a shape the size is not known.
    let shapeless = |moment: f64| load(&urdf::robot(&[link("a", 3.0, [0.0; 2], moment, "")]));
    let words = "with an inertia that needs a part far beyond the robot's size: a; ";
    assert!(only_caution(&shapeless(5000.0)).starts_with(words));
    assert_eq!(shapeless(10.0).reading().cautions, [""; 0]);
    let massless = |moment: f64| {
        let links = [link("a", 1.0, [0.0; 2], 1.0, ""), link("b", 0.0, [0.0; 2], moment, "")];
        load(&urdf::robot(&[links.concat(), joint("j", HINGE, ["a", "b"], [0.0, -1.0], "")]))
    };
    let limited = |[lower, upper]: [f64; 2]| {
        let [torso, leg] = ["torso", "leg"].map(|name| link(name, 1.0, [0.0; 2], 1.0, ""));
        let hip = joint("hip", HINGE, ["torso", "leg"], [0.0, -1.0], "");
        let hip = hip.replace("lower=\"-9\" upper=\"9\"", &format!("lower=\"{lower}\" upper=\"{upper}\""));
        load(&urdf::robot(&[torso, leg, hip])).reading().cautions.clone()
    };
    assert_eq!(limited([-90.0, 120.0]), ["with limits as in degrees: hip; angles are in radians"]);
    assert_eq!(limited([-10.0, 10.0]), [""; 0]);
    assert_eq!(limited([-31.4, 31.4]), [""; 0]);
    let words = "with an inertia but no mass: b; give the mass in kg, or leave out the <inertia>";
    assert_eq!(only_caution(&massless(1.0)), words);
    let words =
        "without mass, although a joint of its own moves it: b; give it an <inertial>, or name the joint in `held`";
    assert_eq!(only_caution(&massless(0.0)), words);
    // What follows a joint may weigh something.
    let links = [("a", 1.0), ("b", 0.0), ("c", 1.0)].map(|(name, mass)| link(name, mass, [0.0; 2], mass, ""));
    let joints = [("j", "b", ""), ("k", "c", "<mimic joint=\"j\"/>")];
    let joints = joints.map(|(name, child, more)| joint(name, HINGE, ["a", child], [0.0, -1.0], more));
    assert_eq!(load(&urdf::robot(&[links.concat(), joints.concat()])).reading().cautions, [""; 0]);
    // A whole turn, the moment of a planar model, a point mass that is meant, nothing at all.
    for (from, to) in [
        (drawn, "<origin xyz=\"0 0 -0.5\" rpy=\"0 6.2832 0\"/><geometry>"),
        (inertia, "<inertia ixx=\"0\" iyy=\"0.05\" izz=\"0\"/>"),
        (inertia, "<inertia ixx=\"0\" iyy=\"1e-4\" izz=\"0\"/>"),
        (inertia, "<inertia ixx=\"0\" iyy=\"0\" izz=\"0\"/>"),
        (inertia, inertia),
    ] {
        assert_eq!(replaced(from, to).reading().cautions, [""; 0], "{to}");
    }
}

#[test]
fn lengths_that_look_like_millimeters_are_noted() {
    let box_of = |size: &str| {
        let shape = urdf::collision([0.0; 2], &format!("box size=\"0.1 0.1 {size}\""));
        load(&urdf::robot(&[link("a", 1.0, [0.0; 2], 1.0, &shape)]))
    };
    let caution = box_of("400");
    let caution = only_caution(&caution);
    assert!(caution.starts_with("a shape of a spans 400 m: lengths are in meters"), "{caution}");
    assert!(box_of("4").reading().cautions.is_empty());
    let far = load(&massive(&[PITCH]).replace("0 0 -1", "0 0 -350"));
    assert!(only_caution(&far).starts_with("the origin of j is 350 m away"), "{}", only_caution(&far));
    let sole = urdf::collision([0.0, -500.0], "sphere radius=\"0.02\"");
    let far = load(&urdf::robot(&[link("a", 1.0, [0.0; 2], 1.0, &sole)]));
    assert!(only_caution(&far).starts_with("the origin of a shape of a is 500 m away"), "{}", only_caution(&far));
}

#[test]
fn shapes_that_urdf_does_not_have_are_noted() {
    let feet = ["ellipsoid radii=\"1 1 1\"", "plane normal=\"0 0 1\""].map(|shape| urdf::collision([0.0; 2], shape));
    let with = |shapes: &str| load(&urdf::robot(&[link("a", 1.0, [0.0; 2], 1.0, shapes)])).reading().cautions.clone();
    let words = "1 collision shape is left out, so that nothing touches there (<ellipsoid> of a): give a shape of URDF, or \
                 name a foot by `feet: LINK:X,Y,Z`";
    assert_eq!(with(&feet[0]), [words]);
    assert!(with(&feet.concat())[0].starts_with("2 collision shapes are left out"));
}

#[test]
fn a_sole_turned_by_3_14_is_flat() {
    let corners = |roll: f64| {
        let sole = format!(
            "<collision><origin rpy=\"{roll} 0 0\"/><geometry><cylinder radius=\"0.1\" length=\"0.03\"/></geometry>\
             </collision>"
        );
        let robot = load(&urdf::robot(&[link("a", 1.0, [0.0; 2], 1.0, &sole)]));
        robot.links()[0].shapes[0].corners().len()
    };
    assert_eq!([0.0, 314.0 / 100.0, 1e-2].map(corners), [4, 4, 2]);
}

#[test]
fn a_mass_in_grams_is_noted() {
    let of_mass = |mass: f64| {
        let shape = urdf::collision([0.0; 2], "sphere radius=\"0.1\"");
        load(&urdf::robot(&[link("a", mass, [0.0; 2], 4e-3 * mass, &shape)]))
    };
    assert!(of_mass(32.0).reading().cautions.is_empty());
    let words = "the robot weighs 2000 kg, more than a ball of steel around all of it (radius 0.1 m): masses are in kg";
    assert_eq!(of_mass(2000.0).reading().cautions.last().unwrap(), words);
    // What slides may be as long as its joint reaches, which the size at zero does not show.
    let [body, foot] = ["body", "foot"].map(|name| {
        let shape = urdf::collision([0.0; 2], "sphere radius=\"0.03\"");
        link(name, 5.0, [0.0; 2], 4e-3, if name == "foot" { &shape } else { "" })
    });
    let slide = "<joint name=\"leg\" type=\"prismatic\"><parent link=\"body\"/><child link=\"foot\"/><axis xyz=\"0 0 1\"/>\
                 <limit lower=\"-1\" upper=\"0\"/></joint>";
    assert_eq!(load(&urdf::robot(&[body, foot, slide.to_owned()])).reading().cautions, [""; 0]);
}

#[test]
fn moments_about_another_axis_and_no_mass_are_noted() {
    let inertia = "<inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\"/>";
    let limb = |name: &str, inertial: &str| format!("<link name=\"{name}\">{inertial}</link>");
    let massive = |inertia: &str| format!("<inertial><mass value=\"1\"/>{inertia}</inertial>");
    let turned = |name: &str, ends: [&str; 2], z: f64| {
        let [parent, child] = ends;
        format!(
            "<joint name=\"{name}\" type=\"continuous\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <origin xyz=\"0 0 {z}\"/><axis xyz=\"0 1 0\"/></joint>"
        )
    };
    let cautions = |thigh: &str, knee: f64| {
        let parts = [limb("body", &massive(inertia)), limb("thigh", thigh), limb("shank", &massive(inertia))];
        let joints = [turned("hip", ["body", "thigh"], -0.5), turned("knee", ["thigh", "shank"], knee)];
        load(&robot(&(parts.concat() + &joints.concat()))).reading().cautions.clone()
    };
    assert_eq!(cautions(&massive(inertia), -0.5), [""; 0]);
    let aside = massive("<inertia ixx=\"0\" iyy=\"0\" izz=\"0.01\"/>");
    let words = "with a single moment of inertia, which is not about the plane's normal: thigh; only that about the normal counts";
    assert_eq!(cautions(&aside, -0.5), [words]);
    assert_eq!(cautions(&massive("<inertia ixx=\"0\" iyy=\"0.01\" izz=\"0\"/>"), -0.5), [""; 0]);
    let words =
        "without mass, although a joint of its own moves it: thigh; give it an <inertial>, or name the joint in `held`";
    assert_eq!(cautions("", -0.5), [words]);
    // A joint of two axes has a link without length between them.
    assert_eq!(cautions("", 0.0), [""; 0]);
    // What is fixed to a frame has its mass, whether it is welded to it or kept apart.
    let parts = [limb("body", &massive(inertia)), limb("thigh", ""), limb("shank", &massive(inertia))];
    let fixed = turned("knee", ["thigh", "shank"], -0.5).replace("continuous", "fixed");
    let text = robot(&(parts.concat() + &turned("hip", ["body", "thigh"], -0.5) + &fixed));
    for weld in [true, false] {
        let reductions = heelstrike::reductions::Reductions { weld, ..Default::default() };
        assert_eq!(
            reduce(&text, &Reduction { reductions, ..Reduction::default() }).reading().cautions,
            [""; 0],
            "{weld}"
        );
    }
}
