//! COLLADA 1.4: the positions of the geometries that the scene shows, each through the frames of its nodes, in metres.
//!
//! ```text
//! x = meter · M_1 … M_k p        M of each node: its matrix, translate, rotate and scale from left to right
//! ```
//! `unit` is heeded, `up_axis` is not: the axes are those of the file, as ROS takes them. A geometry that no scene shows is taken
//! where there is no scene at all. Skinned meshes (controllers) are refused: their points stand in another pose.

use std::collections::HashMap;

use armid::input::size::MESH_POINTS;
use nalgebra::{Matrix4, Rotation3, Unit, Vector3};
use roxmltree::{Document, Node};

/// Nodes inside nodes at most, and nodes that are looked at in all: instances of instances multiply.
const DEEPEST: usize = 100;
const NODES: usize = 100_000;

/// The points of the scene.
pub(super) fn points(text: &str) -> Result<Vec<Vector3<f64>>, String> {
    let document = Document::parse(text).map_err(|fault| format!("malformed XML: {fault}"))?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err(format!("the root element is <{}>, expected <COLLADA>", root.tag_name().name()));
    }
    let meter =
        match child(root, "asset").and_then(|asset| child(asset, "unit")).and_then(|unit| unit.attribute("meter")) {
            Some(meter) => numbers::<1>(meter)?[0],
            None => 1.0,
        };
    let by_id = document.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect();
    let mut reader = Reader { by_id, points: Vec::new(), nodes: 0 };
    let from_file = Matrix4::new_scaling(meter);
    let shown: Vec<Node<'_, '_>> = match child(root, "scene").and_then(|scene| child(scene, "instance_visual_scene")) {
        Some(instance) => vec![reader.target(instance, "url")?],
        None => children(root, "library_visual_scenes").flat_map(|all| children(all, "visual_scene")).collect(),
    };
    for scene in &shown {
        for node in children(*scene, "node") {
            reader.node(node, &from_file, 0)?;
        }
    }
    if shown.is_empty() {
        for geometry in children(root, "library_geometries").flat_map(|all| children(all, "geometry")) {
            reader.geometry(geometry, &from_file)?;
        }
    }
    Ok(reader.points)
}

fn children<'a>(node: Node<'a, 'a>, tag: &'static str) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children().filter(move |child| child.is_element() && child.tag_name().name() == tag)
}

fn child<'a>(node: Node<'a, 'a>, tag: &'static str) -> Option<Node<'a, 'a>> {
    children(node, tag).next()
}

/// Exactly `N` finite numbers.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let found: Option<Vec<f64>> = text.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
    let found: Option<[f64; N]> =
        found.filter(|all| all.iter().all(|x| x.is_finite())).and_then(|all| all.try_into().ok());
    found.ok_or_else(|| {
        let shown: String = text.chars().take(40).collect();
        format!("\"{shown}\", expected {N} finite number{}", if N == 1 { "" } else { "s" })
    })
}

struct Reader<'a> {
    by_id: HashMap<&'a str, Node<'a, 'a>>,
    points: Vec<Vector3<f64>>,
    nodes: usize,
}

impl<'a> Reader<'a> {
    /// What an attribute `#id` means.
    fn target(&self, node: Node<'a, 'a>, key: &str) -> Result<Node<'a, 'a>, String> {
        let url = node.attribute(key).unwrap_or_default();
        let found = url.strip_prefix('#').and_then(|id| self.by_id.get(id));
        found.copied().ok_or_else(|| {
            format!("<{}> names \"{url}\", expected # and the id of an element of the file", node.tag_name().name())
        })
    }

    fn node(&mut self, node: Node<'a, 'a>, parent: &Matrix4<f64>, depth: usize) -> Result<(), String> {
        self.nodes += 1;
        if depth > DEEPEST || self.nodes > NODES {
            return Err(format!("nodes inside {DEEPEST} others or more than {NODES} of them, expected fewer"));
        }
        let mut pose = *parent;
        for step in node.children().filter(Node::is_element) {
            let text = step.text().unwrap_or_default();
            match step.tag_name().name() {
                "matrix" => pose *= Matrix4::from_row_slice(&numbers::<16>(text)?),
                "translate" => pose *= Matrix4::new_translation(&Vector3::from(numbers::<3>(text)?)),
                "scale" => pose *= Matrix4::new_nonuniform_scaling(&Vector3::from(numbers::<3>(text)?)),
                "rotate" => {
                    let [x, y, z, degrees] = numbers::<4>(text)?;
                    let axis = Unit::try_new(Vector3::new(x, y, z), 0.0);
                    let axis = axis.ok_or("<rotate> has the zero vector as its axis, expected a direction")?;
                    pose *= Rotation3::from_axis_angle(&axis, degrees.to_radians()).to_homogeneous();
                }
                tag @ ("lookat" | "skew" | "instance_controller") => {
                    return Err(format!(
                        "<{tag}> in a node is not read, expected matrix, translate, rotate, scale and geometries"
                    ));
                }
                _ => {}
            }
        }
        for instance in children(node, "instance_geometry") {
            let geometry = self.target(instance, "url")?;
            self.geometry(geometry, &pose)?;
        }
        for inner in children(node, "node") {
            self.node(inner, &pose, depth + 1)?;
        }
        for instance in children(node, "instance_node") {
            let inner = self.target(instance, "url")?;
            self.node(inner, &pose, depth + 1)?;
        }
        Ok(())
    }

    /// The positions of a mesh.
    fn geometry(&mut self, geometry: Node<'a, 'a>, pose: &Matrix4<f64>) -> Result<(), String> {
        let Some(vertices) = child(geometry, "mesh").and_then(|mesh| child(mesh, "vertices")) else {
            return Err("a <geometry> has no <mesh> with <vertices>, expected one".to_owned());
        };
        let position = children(vertices, "input").find(|input| input.attribute("semantic") == Some("POSITION"));
        let Some(position) = position else {
            return Err("<vertices> have no input POSITION, expected one".to_owned());
        };
        let source = self.target(position, "source")?;
        let values = child(source, "float_array").and_then(|values| values.text()).unwrap_or_default();
        let accessor = child(source, "technique_common").and_then(|common| child(common, "accessor"));
        let key = |key: &str, usual: usize| -> Result<usize, String> {
            let Some(text) = accessor.and_then(|accessor| accessor.attribute(key)) else { return Ok(usual) };
            text.parse().map_err(|_| format!("{key} of an accessor is \"{text}\", expected a whole number"))
        };
        let (stride, offset) = (key("stride", 3)?.max(3), key("offset", 0)?);
        let values: Option<Vec<f64>> = values.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
        let values = values.ok_or("a <float_array> has a word that is no number, expected numbers alone")?;
        for corner in values.get(offset..).unwrap_or_default().chunks(stride).filter(|corner| corner.len() >= 3) {
            let at = pose * Vector3::new(corner[0], corner[1], corner[2]).push(1.0);
            self.points.push(at.xyz());
        }
        MESH_POINTS.check_count("number of points", self.points.len()).map_err(|fault| fault.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = r##"<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="6">1 2 3 4 5 6</float_array>
<technique_common><accessor source="#a" count="2" stride="3"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>10 0 0</translate><rotate>0 0 1 90</rotate>
<node><matrix>2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1</matrix><instance_geometry url="#g"/></node></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"##;

    #[test]
    fn positions_go_through_the_frames_of_their_nodes_in_metres() {
        let found = points(SCENE).unwrap();
        // 2 (1, 2, 3) a quarter turn about z, then 10 along x, in millimetres.
        let expected = [Vector3::new(0.006, 0.002, 0.006), Vector3::new(0.0, 0.008, 0.012)];
        assert_eq!(found.len(), 2);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).norm() < 1e-15, "{found} {expected}");
        }
    }

    #[test]
    fn a_scene_without_end_and_a_skin_are_refused() {
        let loops = SCENE.replace("<instance_geometry url=\"#g\"/>", "<instance_node url=\"#n\"/>");
        assert!(points(&loops).unwrap_err().contains("expected fewer"));
        let skinned = SCENE.replace("instance_geometry", "instance_controller");
        assert!(points(&skinned).unwrap_err().contains("instance_controller"));
        assert!(points(&SCENE.replace("url=\"#g\"", "url=\"#h\"")).unwrap_err().contains("\"#h\""));
        assert!(points("<robot/>").unwrap_err().contains("expected <COLLADA>"));
        assert!(points("<COLLADA").unwrap_err().contains("malformed"));
    }
}
