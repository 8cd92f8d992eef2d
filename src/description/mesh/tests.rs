//! Compares the readers of mesh files with shapes written by hand.

use super::*;

/// A square pyramid: four corners on the ground and a tip.
const PYRAMID: [[f64; 3]; 5] =
    [[0.25, 0.5, 0.0], [-0.25, 0.5, 0.0], [-0.25, -0.5, 0.0], [0.25, -0.5, 0.0], [0.125, 0.0, 0.75]];
const TRIANGLES: [[usize; 3]; 6] = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [0, 2, 1], [0, 3, 2]];

fn ascii_stl() -> String {
    let vertex = |at: usize| format!("  vertex{}\n", PYRAMID[at].map(|number| format!(" {number:e}")).concat());
    let facet = |triangle: &[usize; 3]| {
        format!("facet normal 0 0 0\n outer loop\n{} endloop\nendfacet\n", triangle.map(vertex).concat())
    };
    format!("solid foot\n{}endsolid foot\n", TRIANGLES.iter().map(facet).collect::<String>())
}

fn binary_stl(header: &[u8]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, 0);
    bytes.extend((TRIANGLES.len() as u32).to_le_bytes());
    for triangle in TRIANGLES {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flat_map(|&at| PYRAMID[at]).flat_map(|number| (number as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn obj() -> String {
    let vertices = PYRAMID.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    // Some faces count back from the last vertex, the bottom is one face of four, and one vertex belongs to no face.
    format!(
        "# caf\u{e9}\nmtllib foot.mtl\no foot\n{vertices}v 9 9 9\nvn 0 0 1\nf 1 2 5\nf 2//1 3//1 5//1\nf -4 -3 -2\nf 4 1 5\nf 4 3 2 1\n"
    )
}

/// Returns a COLLADA text with `asset` and `scene` in which the geometry has these `points`.
fn dae(asset: &str, scene: &str, points: &[[f64; 3]]) -> String {
    let numbers: String = points.iter().flatten().map(|number| format!("{number} ")).collect();
    let corners: String = (0..points.len()).map(|at| format!(" {at}")).collect();
    format!(
        r##"<?xml version="1.0" encoding="utf-8"?>
        <COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>{asset}</asset>
        <library_geometries><geometry id="foot"><mesh>
          <source id="normals"><float_array id="n" count="3">7 7 7</float_array></source>
          <source id="positions"><float_array id="p" count="{}">{numbers}</float_array><technique_common>
            <accessor source="#p" count="{}" stride="3"/></technique_common></source>
          <vertices id="v"><input semantic="NORMAL" source="#normals"/><input semantic="POSITION" source="#positions"/></vertices>
          <triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>{corners}</p></triangles>
        </mesh></geometry></library_geometries>{scene}</COLLADA>"##,
        3 * points.len(),
        points.len()
    )
}

fn scene(nodes: &str) -> String {
    format!(
        r##"<library_visual_scenes><visual_scene id="unused"/><visual_scene id="s">{nodes}</visual_scene>
        </library_visual_scenes><scene><instance_visual_scene url="#s"/></scene>"##
    )
}

const SHOWN: &str = r##"<instance_geometry url="#foot"/>"##;

fn mesh(file: &str, bytes: impl Into<Vec<u8>>) -> std::result::Result<Vec<[f64; 3]>, String> {
    read(file, &bytes.into(), &mut 0)
}

/// Returns the vertices sorted and without repetitions.
#[track_caller]
fn vertices(file: &str, bytes: impl Into<Vec<u8>>) -> Vec<[f64; 3]> {
    sorted(&mesh(file, bytes).unwrap_or_else(|why| panic!("{file}: {why}")))
}

fn sorted(vertices: &[[f64; 3]]) -> Vec<[f64; 3]> {
    // Adding 0 turns -0 into 0.
    let mut vertices: Vec<_> = vertices.iter().map(|vertex| vertex.map(|number| number + 0.0)).collect();
    vertices.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    vertices.dedup();
    vertices
}

#[track_caller]
fn assert_near(found: &[[f64; 3]], expected: &[[f64; 3]]) {
    let far = found.iter().flatten().zip(expected.iter().flatten()).any(|(a, b)| (a - b).abs() > 1e-15);
    assert!(found.len() == expected.len() && !far, "{found:?} is not {expected:?}");
}

#[test]
fn every_format_gives_the_same_vertices() {
    let shown = scene(&format!("<node>{SHOWN}</node>"));
    let begun = binary_stl(b"solid foot");
    let triangles: Vec<u8> = begun[84..].chunks(50).cycle().take(10).flatten().copied().collect();
    let ten_triangles = [&begun[..80], &10_u32.to_le_bytes(), &triangles].concat();
    for (file, bytes) in [
        ("foot.stl", ascii_stl().into()),
        ("foot.stl", ascii_stl().to_ascii_uppercase().into()),
        ("foot.stl", format!("\u{feff}{}", ascii_stl().replace("solid foot", "solid")).into()),
        ("foot.stl", ascii_stl().replace("solid foot", "solid facet").into()),
        ("foot.stl", ascii_stl().replace("foot", "Fu\u{df}").into()),
        ("foot.STL", binary_stl(b"by hand")),
        ("foot.STL", [binary_stl(b"by hand"), vec![7; 60]].concat()),
        // Many programs begin a binary file like a text.
        ("foot.stl", binary_stl(b"solid foot")),
        // Some readers take a binary file for text if a byte of its number of triangles is a line break.
        ("foot.stl", ten_triangles),
        ("foot.obj", obj().into()),
        ("foot.dae", dae("<up_axis>Z_UP</up_axis>", &shown, &PYRAMID).into()),
        ("foot.dae", dae("", "", &PYRAMID).into()),
        ("a.b/foot.Dae", format!("\u{feff}{}", dae("", &shown, &PYRAMID)).into()),
        ("a.dae", dae("<up_axis>Y_UP</up_axis>", &shown, &PYRAMID).into()),
    ] {
        assert_eq!(vertices(file, bytes), sorted(&PYRAMID), "{file}");
    }
    let millimeters = PYRAMID.map(|vertex| vertex.map(|number| 1000.0 * number));
    let found = vertices("a.dae", dae("<unit name=\"mm\" meter=\"0.001\"/>", &shown, &millimeters));
    assert_near(&found, &sorted(&PYRAMID));
    // Text formats keep all digits.
    assert_eq!(vertices("a.obj", "v 0.1 0.2 -0.3\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")[1], [0.1, 0.2, -0.3]);
    assert_eq!(vertices("a.dae", dae("", "", &[[0.1, 0.2, -0.3]])), [[0.1, 0.2, -0.3]]);
    // The array holds normals after the positions.
    let shared = dae("", &shown, &[&PYRAMID[..], &[[7.0; 3]; 2]].concat());
    let shared = shared.replace("count=\"7\" stride", "count=\"5\" stride").replace(" 5 6</p>", "</p>");
    assert_eq!(vertices("a.dae", shared), sorted(&PYRAMID));
    let commented = dae("", "", &[[0.1, 0.2, -0.3]]).replacen("0.2", "<!-- y --> 0.2", 1);
    assert_eq!(vertices("a.dae", commented), [[0.1, 0.2, -0.3]]);
}

#[test]
fn collada_vertices_that_nothing_uses_are_left_out() {
    let all = dae("", "", &[&PYRAMID[..], &[[9.0; 3]]].concat());
    let primitives = |text: &str| {
        let (before, triangles) = all.split_once("<triangles").expect("triangles");
        let after = triangles.split_once("</triangles>").expect("an end").1;
        vertices("a.dae", format!("{before}{text}{after}"))
    };
    let input = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"1\"/>";
    let normals = "<input semantic=\"NORMAL\" source=\"#normals\" offset=\"0\"/>";
    assert_eq!(
        primitives(&format!(
            "<polylist>{normals}{input}<vcount>4</vcount><p>5 0 5 1 5 2 5 3</p></polylist>\
             <tristrips>{input}<p>9 1 9 2 9 4</p></tristrips>"
        )),
        sorted(&PYRAMID)
    );
    let hole = format!("<polygons>{input}<ph><p>7 0 7 1 7 2</p><h>7 3 7 4</h></ph></polygons>");
    assert_eq!(primitives(&hole), sorted(&PYRAMID));
}

#[test]
fn collada_nodes_place_their_geometries() {
    let placed = |nodes: &str| vertices("a.dae", dae("", &scene(nodes), &[[1.0, 2.0, 3.0]]));
    // Rotated by 90 degrees about z, then moved: (1, 2, 3) -> (-2, 1, 3) -> (8, 1, 3).
    let turned = "<translate>10 0 0</translate><rotate>0 0 1 90</rotate>";
    assert_near(&placed(&format!("<node>{turned}{SHOWN}</node>")), &[[8.0, 1.0, 3.0]]);
    // The outer node scales the result of the inner node.
    let nested = format!("<node><scale>2 2 2</scale><node>{turned}{SHOWN}</node></node>");
    assert_near(&placed(&nested), &[[16.0, 2.0, 6.0]]);
    let matrix = "<matrix>0 -1 0 10 1 0 0 0 0 0 1 0 0 0 0 1</matrix>";
    assert_near(&placed(&format!("<node>{matrix}{SHOWN}</node>")), &[[8.0, 1.0, 3.0]]);
    // One geometry shown twice, once by a node instance.
    let twice = format!(
        r##"<node id="n"><translate>1 0 0</translate>{SHOWN}</node>
            <node><translate>0 5 0</translate><instance_node url="#n"/></node>"##
    );
    assert_near(&placed(&twice), &[[2.0, 2.0, 3.0], [2.0, 7.0, 3.0]]);
}

#[test]
fn files_that_cannot_be_read_have_a_reason() {
    let mut with_nan = binary_stl(b"");
    with_nan[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
    let in_scene = |nodes: &str| dae("", &scene(nodes), &PYRAMID);
    let circle = r##"<node id="a"><instance_node url="#b"/></node><node id="b"><instance_node url="#a"/></node>"##;
    // Sixty nodes, each of which shows the next one twice: 2^60 instances.
    let twice = |k: usize| format!("<instance_node url=\"#n{}\"/>", k + 1).repeat(2);
    let doubled: String = (0..60).map(|k| format!("<node id=\"n{k}\">{}</node>", twice(k))).collect();
    let endless = "cannot be read: its nodes are too many, or name each other in a circle";
    for (file, bytes, reason) in [
        ("foot.ply", "ply".into(), "not a mesh of a kind that is read: STL, OBJ or DAE"),
        (
            "foot.stl",
            "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n".into(),
            "only a pointer to the file is there: fetch it by git lfs pull",
        ),
        ("a.obj", "o nothing\nv 0 0 0\n".into(), "it has no vertices"),
        ("a.obj", "v 0 0 nan\nf 1 1 1\n".into(), "one of its vertices has the coordinate NaN"),
        ("a.obj", "v 0 0 1e999\nf 1 1 1\n".into(), "one of its vertices has the coordinate inf"),
        ("a.stl", with_nan, "one of its vertices has the coordinate NaN"),
        ("a.stl", Vec::new(), "cannot be read: "),
        ("a.stl", binary_stl(b"")[..200].into(), "cannot be read: "),
        // The file is cut between two triangles; the rest would make another foot.
        ("a.stl", binary_stl(b"")[..84 + 50].into(), "cannot be read: 6 triangles are announced, 1 are there"),
        ("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 1 2".into(), "cannot be read: "),
        ("a.obj", "v 0 0 0\nf 1 2 3\n".into(), "cannot be read: "),
        ("a.dae", "<COLLADA>".into(), "cannot be read: "),
        (
            "a.dae",
            dae("", "", &PYRAMID).replacen("count=\"15\"", "count=\"18\"", 1).into(),
            "cannot be read: 18 numbers are announced, 15 are there",
        ),
        ("a.dae", dae("", "", &PYRAMID).replace("VERTEX", "NORMAL").into(), "it has no vertices"),
        (
            "a.dae",
            dae("", "", &PYRAMID).replace(" 4</p>", " 5</p>").into(),
            "cannot be read: \"5\" is the index of no vertex",
        ),
        ("a.dae", "<robot/>".into(), "cannot be read: "),
        ("a.dae", dae("<unit meter=\"x\"/>", "", &PYRAMID).into(), "cannot be read: "),
        ("a.dae", dae("<unit meter=\"0\"/>", "", &PYRAMID).into(), "cannot be read: its unit is 0 m"),
        ("a.dae", in_scene("<node><instance_geometry url=\"#hand\"/></node>").into(), "cannot be read: "),
        ("a.dae", in_scene("<node><rotate>1 2 3</rotate></node>").into(), "cannot be read: "),
        ("a.dae", in_scene(circle).into(), endless),
        ("a.dae", in_scene(&format!("{doubled}<node id=\"n60\"/>")).into(), endless),
    ] {
        let why = mesh(file, bytes).expect_err(file);
        assert!(if reason.ends_with(' ') { why.starts_with(reason) } else { why == reason }, "{file}: {why}");
    }
}

#[test]
fn mutilated_files_never_panic() {
    let shown = scene(&format!("<node><translate>1 0 0</translate>{SHOWN}</node>"));
    let files: [(&str, Vec<u8>); 4] = [
        ("a.stl", binary_stl(b"")),
        ("a.stl", ascii_stl().into()),
        ("a.obj", obj().into()),
        ("a.dae", dae("<up_axis>Y_UP</up_axis>", &shown, &PYRAMID).into()),
    ];
    let mut seed = 1_u64;
    let mut next = |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below
    };
    let mut read = 0;
    for round in 0..20_000 {
        let (file, mut bytes) = files[round % files.len()].clone();
        match next(4) {
            0 => bytes.truncate(next(bytes.len())),
            1 => bytes = (0..next(300)).map(|_| next(256) as u8).collect(),
            _ => {
                for _ in 0..1 + next(4) {
                    let at = next(bytes.len());
                    bytes[at] = if next(2) == 0 { next(256) as u8 } else { b"0 -9/#<>e.\n"[next(11)] };
                }
            }
        }
        read += usize::from(mesh(file, bytes).is_ok());
    }
    assert!(read > 1000, "{read} were read");
}

#[test]
fn mesh_is_read_once() {
    let collision = |file: &str| format!("<collision><geometry><mesh filename=\"{file}\"/></geometry></collision>");
    let collisions = ["x.obj", "y.obj", "x.obj"].map(collision).concat();
    let urdf = format!("<robot name=\"r\">\n<link name=\"a\">{collisions}</link></robot>");
    let mut description = Description::from_urdf(&urdf).expect("a description");
    let mut asked = Vec::new();
    let fetch = |file: &str| {
        asked.push(file.to_owned());
        if file == "x.obj" { Ok(obj().into()) } else { Err("gone".into()) }
    };
    description.read_meshes(fetch);
    assert_eq!(asked, ["x.obj", "y.obj"]);
    let read = |at: usize| match &description.links[0].collisions[at].geometry {
        Geometry::Mesh { mesh, .. } => mesh.clone(),
        other => panic!("{other:?}"),
    };
    assert_eq!((read(0), read(1)), (read(2), Mesh::LeftOut { why: "gone".into() }));
    assert_ne!(read(0), Mesh::Unread);
}
