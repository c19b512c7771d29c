//! The geometries of a URDF file, as nodes: boxes, cylinders, spheres, and meshes from other files, each file
//! read once however often it is placed.
//!
//! Round shapes are made of triangles that lie within them: a cylinder has 40 sides (at most 0.31 % of its radius
//! inside), a sphere 1280 triangles (at most 0.47 %).

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::{Affine3A, Vec3};

use super::super::generate::{cuboid, cylinder, geodesic};
use super::super::source::{Source, Stamp, format_of};
use super::super::{Mesh, Scene, SceneError};
use super::gltf_buffers::unescape;
use super::urdf_xml::{Element, Xml};
use super::{FORMATS, read};

/// Triangles of a cylinder: 40 sides in 4 rings, and two ends.
const CYLINDER: u32 = 396;
/// How often each edge of an icosahedron is divided to make a sphere.
const SPHERE: u32 = 8;
/// A file of many nodes can be placed many times in few bytes. No robot has this many, but a trap for memory does.
const MOST_NODES: usize = 1 << 16;

/// What has been placed so far, so that it can be shared.
pub(super) struct Shapes<'a> {
    source: &'a Source,
    xml: &'a Xml<'a>,
    /// Meshes of size 1 by the name of their shape, as indices.
    units: HashMap<&'static str, u32>,
    /// Files by where they really are.
    files: HashMap<PathBuf, Part>,
    /// For each package the way to its folder, if a `package.xml` tells it.
    packages: HashMap<String, Option<String>>,
}

/// A file that has been read: its graph, with the indices that its meshes have in the robot's.
struct Part {
    scene: Scene,
    name: String,
}

impl<'a> Shapes<'a> {
    pub(super) fn new(source: &'a Source, xml: &'a Xml<'a>) -> Self {
        let (units, files, packages) = Default::default();
        Self { source, xml, units, files, packages }
    }

    /// Places the geometry of a `visual` or `collision` element below a node.
    ///
    /// # Errors
    /// [`SceneError::Malformed`] with the line of what is not right.
    pub(super) fn place(
        &mut self,
        scene: &mut Scene,
        above: u32,
        element: Element<'a>,
    ) -> Result<(), SceneError> {
        let xml = self.xml;
        let origin = xml.origin(element)?;
        let geometry = xml.one(element, "geometry")?;
        let mut shapes = xml.below(geometry);
        let (Some(shape), None) = (shapes.next(), shapes.next()) else {
            return Err(xml.fail(geometry, "<geometry> of no shape or several", "one shape in it"));
        };
        let size = match shape.tag_name().name() {
            "box" => xml.sizes::<3>(shape, "size")?,
            "sphere" => [xml.sizes::<1>(shape, "radius")?[0]; 3],
            "cylinder" => {
                let [radius] = xml.sizes(shape, "radius")?;
                let [length] = xml.sizes(shape, "length")?;
                [radius, radius, length]
            }
            "mesh" => {
                let size = xml.numbers(shape, "scale")?.unwrap_or([1.0; 3]);
                return self.place_file(scene, above, element, origin * scaled(size), shape);
            }
            other => {
                return Err(xml.fail(shape, format!("shape <{other}>"), "box, cylinder, sphere or mesh"));
            }
        };
        let (kind, make): (&str, fn() -> Mesh) = match shape.tag_name().name() {
            "box" => ("box", unit_box),
            "sphere" => ("sphere", || geodesic("sphere", 1.0, SPHERE)),
            _ => ("cylinder", unit_cylinder),
        };
        let mesh = *self.units.entry(kind).or_insert_with(|| scene.add_mesh(make()));
        let name = element.attribute("name").unwrap_or(kind);
        scene.add_node(Some(above), name, origin * scaled(size), Some(mesh));
        Ok(())
    }

    /// Places a mesh file: as one node if it is one, else as its own graph below a node.
    fn place_file(
        &mut self,
        scene: &mut Scene,
        above: u32,
        element: Element<'a>,
        place: Affine3A,
        shape: Element<'a>,
    ) -> Result<(), SceneError> {
        let filename = self.xml.attribute(shape, "filename")?;
        let xml = self.xml;
        let wrong = |(why, expected)| xml.fail(shape, format!("mesh {filename:?}{why}"), expected);
        let part = self.file(scene, filename).map_err(wrong)?;
        let name = element.attribute("name").unwrap_or(&part.name);
        if let [only] = part.scene.nodes.as_slice() {
            scene.add_node(Some(above), name, place * only.transform, only.mesh);
            return Ok(());
        }
        let top = scene.add_node(Some(above), name, place, None);
        let first = scene.nodes.len() as u32;
        if scene.nodes.len() + part.scene.nodes.len() > MOST_NODES {
            let found = format!("more than {MOST_NODES} nodes with mesh {filename:?}");
            return Err(xml.fail(shape, found, format!("at most {MOST_NODES} in all")));
        }
        scene.nodes[top as usize].children = part.scene.roots.iter().map(|root| root + first).collect();
        scene.nodes.extend(part.scene.nodes.iter().cloned().map(|mut node| {
            node.parent = Some(node.parent.map_or(top, |parent| parent + first));
            node.children.iter_mut().for_each(|child| *child += first);
            node
        }));
        Ok(())
    }

    /// The mesh file of that name, read if it has not been yet; or what is wrong with it and what was expected.
    fn file(&mut self, scene: &mut Scene, filename: &str) -> Result<&Part, (String, String)> {
        let known = FORMATS.iter().map(|format| format.extension).filter(|format| *format != "urdf");
        let format = format_of(Path::new(filename));
        if !known.clone().any(|known| known == format) {
            let known: Vec<String> = known.map(|known| format!(".{known}")).collect();
            let expected = format!("a file of {}, for this or as the link's <collision>", known.join(", "));
            return Err((format!(" of format {format:?}"), expected));
        }
        let name = self.find(filename)?;
        let path = self.source.beside(&name);
        let cannot = |error: String| (format!(", which cannot be read ({error})"), "a mesh file".to_string());
        let real =
            std::fs::canonicalize(&path).map_err(|error| cannot(format!("{}: {error}", path.display())))?;
        if !self.files.contains_key(&real) {
            let (mut part, stamps) = read(&path).map_err(|error| cannot(error.to_string()))?;
            for stamp in stamps {
                let from_here = Path::new(&name).with_file_name(&stamp.name);
                self.source.note(Stamp { name: from_here.to_string_lossy().into_owned(), ..stamp });
            }
            let first = scene.meshes.len() as u32;
            scene.take_look(&mut part);
            scene.meshes.append(&mut part.meshes);
            part.nodes.iter_mut().filter_map(|node| node.mesh.as_mut()).for_each(|mesh| *mesh += first);
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            self.files.insert(real.clone(), Part { scene: part, name });
        }
        Ok(&self.files[&real])
    }

    /// The way to a file from the robot's folder. The files that were looked for are kept in mind, found or not,
    /// since another one might come to be the nearest.
    fn find(&mut self, filename: &str) -> Result<String, (String, String)> {
        if let Some(rest) = filename.strip_prefix("package://") {
            let (package, file) = rest.split_once('/').unwrap_or((rest, ""));
            return self.find_in_package(package, file).ok_or_else(|| {
                let why = format!(
                    ", and from the robot's folder up none has a package.xml that names {package:?}, or has \
                     {package}/{file} in it"
                );
                (why, "a file of a package that is here".to_string())
            });
        }
        match filename.strip_prefix("file://") {
            Some(path) => Ok(unescape(path)),
            None if filename.contains("://") => {
                Err((", an address".to_string(), "a path, file:// or package://".to_string()))
            }
            None => Ok(filename.to_string()),
        }
    }

    /// In the nearest folder, from the robot's own up, whose `package.xml` has that name; or else in a folder of
    /// that name in the nearest of them.
    fn find_in_package(&mut self, package: &str, file: &str) -> Option<String> {
        let source = self.source;
        let levels = std::fs::canonicalize(source.beside(".")).map_or(1, |folder| folder.ancestors().count());
        let folders = (0..levels).map(|level| "../".repeat(level));
        let told = self.packages.entry(package.to_string()).or_insert_with(|| {
            folders.clone().find(|folder| {
                let description = format!("{folder}package.xml");
                source.has(&description)
                    && source.neighbour(&description).is_ok_and(|text| is_of_package(&text, package))
            })
        });
        match told {
            Some(folder) => Some(format!("{folder}{file}")),
            None => folders.map(|folder| format!("{folder}{package}/{file}")).find(|way| source.has(way)),
        }
    }
}

/// Whether the text of a `package.xml` names this package.
fn is_of_package(text: &[u8], package: &str) -> bool {
    let Some(xml) = std::str::from_utf8(text).ok().and_then(|text| Xml::parse("package.xml", text).ok())
    else {
        return false;
    };
    let name = xml.root("package").and_then(|root| xml.one(root, "name"));
    name.is_ok_and(|name| name.text().is_some_and(|text| text.trim() == package))
}

fn scaled(size: [f64; 3]) -> Affine3A {
    Affine3A::from_scale(Vec3::from(size.map(|size| size as f32)))
}

/// A box of 1 m about the origin.
fn unit_box() -> Mesh {
    moved(cuboid("box", Vec3::ONE), |position| position - 0.5 * Vec3::Y)
}

/// A cylinder of radius and length 1 m about the origin, along z.
fn unit_cylinder() -> Mesh {
    moved(cylinder("cylinder", 1.0, 1.0, CYLINDER), |p| Vec3::new(p.x, -p.z, p.y - 0.5))
}

fn moved(mesh: Mesh, place: fn(Vec3) -> Vec3) -> Mesh {
    Mesh::new(mesh.name, mesh.positions.into_iter().map(place).collect(), mesh.triangles)
}
