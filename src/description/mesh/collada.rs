//! COLLADA (DAE) -> vertices.
//!
//! ```text
//!     p = unit (T_1 ... T_k p_mesh)         T_1 ... T_k: the transformations of the nodes, from the scene to the mesh
//! ```
//!
//! Only elements that affect vertex positions are read (COLLADA 1.4.1, chapters 5 and 6): asset, visual scene, nodes,
//! and the positions that faces and lines of geometries use. The positions of skins are those of their bind shape. In a
//! file without a visual scene, all geometries are read without transformation. The up axis is not read, as in RViz,
//! MoveIt, Gazebo and Pinocchio: many robot files say y although they use the axes of their link. There is no
//! recursion, and node instances are counted, because a file of a few lines could request 2^100 of them.

use super::super::pose::{Matrix, apply, product, turn, unit};
use super::super::xml;
use roxmltree::{Document, Node, NodeId};
use std::collections::HashMap;

/// Largest number of elements in the scene, with each instance counted.
const MOST_INSTANCES: usize = 2_000_000;
/// Largest number of vertices, with each instance counted.
const MOST_VERTICES: usize = 4_000_000;
/// Largest number of characters in a number.
const LONGEST_NUMBER: usize = 400;
/// Largest nesting depth of nodes, including instances.
const DEEPEST: usize = 200;

/// Tags of the elements that connect vertices to faces or lines.
const PRIMITIVES: [&str; 7] = ["triangles", "polylist", "polygons", "trifans", "tristrips", "lines", "linestrips"];

/// A linear map followed by a translation.
type Transform = (Matrix, [f64; 3]);

const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const UNMOVED: Transform = (IDENTITY, [0.0; 3]);

/// Returns the vertex positions of all geometries in the scene \[m\]. The error is the reason for a failure.
pub(super) fn vertices(bytes: &[u8]) -> Result<Vec<[f64; 3]>, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "the text is not UTF-8".to_owned())?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let document = xml::parse(text).map_err(|(refused, _)| refused.to_string())?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err(format!("the outermost element is <{}> and not <COLLADA>", root.tag_name().name()));
    }
    let unit = child(root, "asset").and_then(|asset| child(asset, "unit"));
    let meters = unit.and_then(|unit| unit.attribute("meter")).map_or(Ok(1.0), number)?;
    if meters <= 0.0 || !meters.is_finite() {
        return Err(format!("its unit is {meters} m"));
    }
    Shown::new(&document).vertices((IDENTITY.map(|row| row.map(|entry| meters * entry)), [0.0; 3]))
}

/// A document, its elements by id, the positions of geometries read so far, and the vertices in its scene.
struct Shown<'a, 'input> {
    document: &'a Document<'input>,
    by_id: HashMap<&'a str, Node<'a, 'input>>,
    positions: HashMap<NodeId, Vec<[f64; 3]>>,
    vertices: Vec<[f64; 3]>,
}

impl<'a, 'input: 'a> Shown<'a, 'input> {
    fn new(document: &'a Document<'input>) -> Self {
        let by_id = document.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect();
        Self { document, by_id, positions: HashMap::new(), vertices: Vec::new() }
    }

    fn elements(&self, tag: &'static str) -> impl Iterator<Item = Node<'a, 'input>> {
        self.document.descendants().filter(move |node| is(*node, tag))
    }

    /// Returns the element that an attribute refers to as `#id`.
    fn target(&self, node: Node<'_, '_>, attribute: &str) -> Result<Node<'a, 'input>, String> {
        let url = node.attribute(attribute).unwrap_or_default();
        let found = url.strip_prefix('#').and_then(|id| self.by_id.get(id));
        found.copied().ok_or_else(|| format!("<{}> names \"{url}\", which is not there", node.tag_name().name()))
    }

    fn vertices(mut self, axes: Transform) -> Result<Vec<[f64; 3]>, String> {
        let scene = match self.elements("instance_visual_scene").next() {
            Some(instance) => Some(self.target(instance, "url")?),
            None => self.elements("visual_scene").next(),
        };
        let Some(scene) = scene else {
            for geometry in self.elements("geometry").collect::<Vec<_>>() {
                self.show(geometry, &axes)?;
            }
            return Ok(self.vertices);
        };
        let mut waiting: Vec<(Node<'a, 'input>, Transform, usize)> = vec![(scene, axes, 0)];
        let mut instances = 0;
        while let Some((parent, outer, depth)) = waiting.pop() {
            let placed = within(&outer, &transformation(parent)?);
            for node in parent.children() {
                instances += 1;
                if instances > MOST_INSTANCES || depth > DEEPEST {
                    return Err("its nodes are too many, or name each other in a circle".into());
                }
                match node.tag_name().name() {
                    "node" => waiting.push((node, placed, depth + 1)),
                    "instance_node" => waiting.push((self.target(node, "url")?, placed, depth + 1)),
                    "instance_geometry" => self.show(self.target(node, "url")?, &placed)?,
                    "instance_controller" => {
                        let controller = self.target(node, "url")?;
                        let skin = child(controller, "skin").ok_or("only skins are read of its controllers")?;
                        let shape = child(skin, "bind_shape_matrix").map_or(Ok(UNMOVED), matrix)?;
                        self.show(self.target(skin, "source")?, &within(&placed, &shape))?;
                    }
                    _ => {}
                }
            }
        }
        Ok(self.vertices)
    }

    /// Adds the transformed vertices of `geometry`.
    fn show(&mut self, geometry: Node<'a, 'input>, placed: &Transform) -> Result<(), String> {
        if !self.positions.contains_key(&geometry.id()) {
            let positions = self.positions(geometry)?;
            self.positions.insert(geometry.id(), positions);
        }
        let positions = self.positions.get(&geometry.id()).map_or(&[][..], Vec::as_slice);
        if self.vertices.len() + positions.len() > MOST_VERTICES {
            return Err(format!("more than {MOST_VERTICES} vertices"));
        }
        self.vertices.extend(positions.iter().map(|&point| moved(placed, point)));
        Ok(())
    }

    /// Returns the positions that faces and lines of `geometry` use, in its own frame.
    fn positions(&self, geometry: Node<'a, 'input>) -> Result<Vec<[f64; 3]>, String> {
        let mut positions = Vec::new();
        let mut corners: HashMap<&str, Vec<_>> = HashMap::new();
        for primitive in geometry.descendants().filter(|node| PRIMITIVES.contains(&node.tag_name().name())) {
            for input in primitive.children().filter(|node| node.attribute("semantic") == Some("VERTEX")) {
                let source = input.attribute("source").and_then(|url| url.strip_prefix('#'));
                corners.entry(source.unwrap_or_default()).or_default().push((primitive, input));
            }
        }
        for vertices in geometry.descendants().filter(|node| is(*node, "vertices")) {
            let position = |node: &Node<'_, '_>| is(*node, "input") && node.attribute("semantic") == Some("POSITION");
            let Some(input) = vertices.children().find(position) else { continue };
            let source = self.target(input, "source")?;
            let array = child(source, "float_array");
            let values = array.map(text).unwrap_or_default();
            let values: Vec<f64> = values.split_whitespace().map(number).collect::<Result<_, _>>()?;
            if let Some(count) = array.and_then(|array| array.attribute("count"))
                && count.trim().parse() != Ok(values.len())
            {
                return Err(format!("{count} numbers are announced, {} are there", values.len()));
            }
            let accessor = child(source, "technique_common").and_then(|common| child(common, "accessor"));
            let count = |name, default| {
                let value = accessor.and_then(|accessor| accessor.attribute(name));
                value.map_or(Ok(default), |value| value.trim().parse().map_err(|_| format!("{name} \"{value}\"")))
            };
            let (offset, stride): (usize, usize) = (count("offset", 0)?, count("stride", 3)?);
            let points = values.get(offset..).unwrap_or_default().chunks(stride.max(3));
            // Other data, such as normals, may follow in the same array.
            let points = points.take(count("count", usize::MAX)?).filter_map(|point| point.first_chunk::<3>());
            let mut used = vec![false; points.clone().count()];
            let corners = corners.remove(vertices.attribute("id").unwrap_or_default());
            corners.into_iter().flatten().try_for_each(|(primitive, input)| mark(primitive, input, &mut used))?;
            positions.extend(points.zip(used).filter_map(|(point, used)| used.then_some(point)));
            if positions.len() > MOST_VERTICES {
                return Err(format!("more than {MOST_VERTICES} vertices"));
            }
        }
        Ok(positions)
    }
}

/// Marks in `used` the vertices to which a primitive refers through `input`, the one of its inputs for vertices.
fn mark(primitive: Node<'_, '_>, input: Node<'_, '_>, used: &mut [bool]) -> Result<(), String> {
    let offset = |input: Node<'_, '_>| input.attribute("offset").and_then(|offset| offset.trim().parse().ok());
    // Each corner has one index per offset; several inputs may share an offset.
    let stride = primitive.children().filter_map(offset).max().unwrap_or(0_usize).saturating_add(1);
    for indices in primitive.descendants().filter(|node| is(*node, "p") || is(*node, "h")) {
        for word in text(indices).split_whitespace().skip(offset(input).unwrap_or(0)).step_by(stride) {
            let vertex = word.parse().ok().and_then(|at: usize| used.get_mut(at));
            *vertex.ok_or_else(|| format!("\"{}\" is the index of no vertex", short(word)))? = true;
        }
    }
    Ok(())
}

/// Returns the product of the transformations in `node`, in their order.
fn transformation(node: Node<'_, '_>) -> Result<Transform, String> {
    let mut placed = UNMOVED;
    for element in node.children() {
        let step = match element.tag_name().name() {
            "matrix" => matrix(element)?,
            "translate" => (IDENTITY, numbers(element)?),
            "scale" => {
                let [x, y, z] = numbers(element)?;
                ([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], [0.0; 3])
            }
            "rotate" => {
                let [x, y, z, degrees] = numbers(element)?;
                let linear = if [x, y, z] == [0.0; 3] { IDENTITY } else { turn(unit([x, y, z]), degrees.to_radians()) };
                (linear, [0.0; 3])
            }
            tag @ ("lookat" | "skew") => return Err(format!("<{tag}> is not read")),
            _ => continue,
        };
        placed = within(&placed, &step);
    }
    Ok(placed)
}

/// Reads the sixteen numbers of an element, row by row, as a transformation.
fn matrix(element: Node<'_, '_>) -> Result<Transform, String> {
    let [a, b, c, x, d, e, f, y, g, h, i, z, ..] = numbers::<16>(element)?;
    Ok(([[a, b, c], [d, e, f], [g, h, i]], [x, y, z]))
}

/// Composes two transformations: first `inner`, then `outer`.
fn within(outer: &Transform, inner: &Transform) -> Transform {
    (product(&outer.0, &inner.0), moved(outer, inner.1))
}

fn moved((linear, offset): &Transform, point: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = apply(linear, point);
    [x + offset[0], y + offset[1], z + offset[2]]
}

fn numbers<const N: usize>(element: Node<'_, '_>) -> Result<[f64; N], String> {
    let values: Vec<f64> = text(element).split_whitespace().take(N + 1).map(number).collect::<Result<_, _>>()?;
    values.try_into().map_err(|_| format!("<{}> needs {N} numbers", element.tag_name().name()))
}

/// Returns the text of an element without comments.
fn text(element: Node<'_, '_>) -> String {
    element.children().filter(Node::is_text).filter_map(|part| part.text()).collect()
}

fn number(word: &str) -> Result<f64, String> {
    let word = word.trim();
    let refused = || format!("\"{}\" is no number", short(word));
    if word.len() > LONGEST_NUMBER { Err(refused()) } else { word.parse().map_err(|_| refused()) }
}

fn short(word: &str) -> String {
    word.chars().take(20).collect()
}

/// Returns the first child of `node` with this tag.
fn child<'a, 'input>(node: Node<'a, 'input>, tag: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| is(*child, tag))
}

/// Returns whether an element has this tag in any namespace: each version of COLLADA has its own.
fn is(node: Node<'_, '_>, tag: &str) -> bool {
    node.is_element() && node.tag_name().name() == tag
}
