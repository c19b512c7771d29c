//! URDF, the robot descriptions of ROS (wiki.ros.org/urdf/XML): the links as their joints place them, all joints at
//! position zero, whether their limits allow that or not. A link becomes a node under that of its parent link, and
//! each of its geometries a node below. Those are its `collision` geometries where it has any, its `visual` ones
//! otherwise: what a robot is made of, not what it is made to look like. Inertia, limits, materials and
//! extensions of other tools are not read. Lengths are metres and z is up.

use std::collections::HashMap;

use glam::Affine3A;

use super::super::source::Source;
use super::super::{Scene, SceneError};
use super::urdf_shapes::Shapes;
use super::urdf_xml::{Element, Xml};

/// Kinds of joint; at position zero all place their child alike.
const JOINTS: [&str; 6] = ["fixed", "revolute", "continuous", "prismatic", "floating", "planar"];

/// A link, and how it hangs together with the others.
struct Link<'a> {
    name: &'a str,
    element: Element<'a>,
    /// The joint that holds it, if any does.
    above: Option<Joint<'a>>,
    /// The links that it holds, by index.
    below: Vec<usize>,
}

/// What holds a link.
struct Joint<'a> {
    name: &'a str,
    element: Element<'a>,
    /// The link it hangs on, by index.
    parent: usize,
    origin: Affine3A,
}

/// Reads the links of a robot.
pub(super) fn load(source: &Source) -> Result<Scene, SceneError> {
    let xml = Xml::parse(&source.file, source.text()?)?;
    let robot = xml.root("robot")?;
    let mut links = read_links(&xml, robot)?;
    join(&xml, robot, &mut links)?;
    let root = root(&xml, robot, &links)?;
    let mut scene = Scene::new(&source.file);
    let mut shapes = Shapes::new(source, &xml);
    let mut reached = vec![false; links.len()];
    let mut stack = vec![(None, root)];
    while let Some((parent, index)) = stack.pop() {
        reached[index] = true;
        let link = &links[index];
        let origin = link.above.as_ref().map_or(Affine3A::IDENTITY, |joint| joint.origin);
        let node = scene.add_node(parent, link.name, origin, None);
        let kind = if xml.all(link.element, "collision").next().is_some() { "collision" } else { "visual" };
        for geometry in xml.all(link.element, kind) {
            shapes.place(&mut scene, node, geometry)?;
        }
        stack.extend(link.below.iter().rev().map(|below| (Some(node), *below)));
    }
    match reached.iter().position(|reached| !reached) {
        Some(lost) => Err(circle(&xml, &links, lost)),
        None => Ok(scene),
    }
}

fn read_links<'a>(xml: &'a Xml<'a>, robot: Element<'a>) -> Result<Vec<Link<'a>>, SceneError> {
    let links = xml.all(robot, "link").map(|element| {
        let name = xml.attribute(element, "name")?;
        Ok(Link { name, element, above: None, below: Vec::new() })
    });
    links.collect()
}

/// Hangs the links on each other as the joints say.
fn join<'a>(xml: &'a Xml<'a>, robot: Element<'a>, links: &mut [Link<'a>]) -> Result<(), SceneError> {
    let mut index_of = HashMap::new();
    for (index, link) in links.iter().enumerate() {
        if index_of.insert(link.name, index).is_some() {
            let found = format!("a second link {:?}", link.name);
            return Err(xml.fail(link.element, found, "one of each name"));
        }
    }
    for element in xml.all(robot, "joint") {
        let name = xml.attribute(element, "name")?;
        let kind = xml.attribute(element, "type")?;
        if !JOINTS.contains(&kind) {
            let found = format!("joint {name:?} of type {kind:?}");
            return Err(xml.fail(element, found, format!("one of {}", JOINTS.join(", "))));
        }
        let end = |end| {
            let end = xml.one(element, end)?;
            let link = xml.attribute(end, "link")?;
            index_of.get(link).copied().ok_or_else(|| {
                let found = format!("joint {name:?} to {link:?}");
                xml.fail(end, found, "the name of a link in this file")
            })
        };
        let (parent, child) = (end("parent")?, end("child")?);
        if let Some(other) = &links[child].above {
            let found =
                format!("link {:?} is held by joints {:?} and {name:?}", links[child].name, other.name);
            return Err(xml.fail(element, found, "one parent at most"));
        }
        links[child].above = Some(Joint { name, element, parent, origin: xml.origin(element)? });
        links[parent].below.push(child);
    }
    Ok(())
}

/// The one link that no joint holds.
fn root(xml: &Xml<'_>, robot: Element<'_>, links: &[Link<'_>]) -> Result<usize, SceneError> {
    let mut roots = (0..links.len()).filter(|link| links[*link].above.is_none());
    match (roots.next(), roots.next()) {
        (Some(root), None) => Ok(root),
        (Some(root), Some(other)) => {
            let found = format!("links {:?} and {:?} have no parent", links[root].name, links[other].name);
            Err(xml.fail(links[other].element, found, "one root"))
        }
        (None, _) if links.is_empty() => Err(xml.fail(robot, "no link", "one or more in <robot>")),
        (None, _) => Err(circle(xml, links, 0)),
    }
}

/// A link that the root does not lead to hangs, by way of its parents, on a circle.
fn circle(xml: &Xml<'_>, links: &[Link<'_>], mut lost: usize) -> SceneError {
    // After as many steps up as there are links, it is on the circle itself.
    for _ in 0..links.len() {
        lost = links[lost].above.as_ref().map_or(lost, |joint| joint.parent);
    }
    let link = &links[lost];
    let (joint, at) = match &link.above {
        Some(joint) => (joint.name, joint.element),
        None => ("", link.element),
    };
    let found = format!("by joint {joint:?}, link {:?} hangs on itself", link.name);
    xml.fail(at, found, "a tree of links, no circle")
}

#[cfg(test)]
#[path = "urdf_tests.rs"]
mod tests;
