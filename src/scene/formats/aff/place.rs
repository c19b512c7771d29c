//! From statements to a scene: carries them out in the order of the text, through all files.

use std::collections::HashMap;
use std::path::{Component, Path};
use std::rc::Rc;

use glam::{Affine3A, Vec3};

use super::super::super::source::Source;
use super::super::super::{Bend, Materials, Mesh, Motion, PointLight, Scene, SceneError, Shading};
use super::looks::{Looks, UNKNOWN};
use super::parse::parse;
use super::round::Rounds;
use super::statement::{Finish, Light, Look, Parsed, Patch, Statement};

/// How deep files may include one another.
const MOST_FILES_DEEP: usize = 64;
/// What a scene may unfold to by files that are included again and again, beyond what its text spells out: vertices,
/// triangles and statements, a node being as good as [`NODE`] of them.
const MOST_REPEATED: u64 = 1 << 25;
const NODE: u64 = 16;
/// The name of the keys that move the camera.
const CAMERA: &str = "camera";

/// What NFF and AFF mean by what is left out.
pub(super) struct Dialect {
    /// Ambient light where there is no `am`.
    pub(super) ambient: Option<Vec3>,
    /// Whether lights without a colour share their brightness out.
    pub(super) dims_lights: bool,
}

/// Reads a file, and what it includes, into a scene.
pub(super) fn place(source: &Source, dialect: Dialect) -> Result<Scene, SceneError> {
    let stem = source.stem();
    let own = Rc::new(parse(&source.file, &stem, &source.bytes)?);
    let mut scene = Scene::new(&source.file);
    (scene.background, scene.ambient) = (Some(Vec3::ZERO), dialect.ambient);
    scene.warnings.extend_from_slice(&own.warnings);
    let root = scene.add_node(None, stem, Affine3A::IDENTITY, None);
    let mut placing = Placing {
        source,
        scene,
        read: HashMap::new(),
        inside: Vec::new(),
        level: 0,
        finish: None,
        nodes: vec![root],
        looks: Looks::default(),
        meshes: HashMap::new(),
        rounds: Rounds::default(),
        moving: Vec::new(),
        plain_lights: Vec::new(),
        moving_lights: Vec::new(),
        motions: HashMap::new(),
        left: MOST_REPEATED + source.bytes.len() as u64,
    };
    placing.file(&own, &source.file, 0)?;
    if dialect.dims_lights {
        let each = 1.0 / (placing.plain_lights.len() as f32).sqrt();
        placing.plain_lights.iter().for_each(|light| placing.scene.lights[*light].colour = Vec3::splat(each));
    }
    Ok(placing.finish())
}

struct Placing<'a> {
    source: &'a Source,
    scene: Scene,
    /// Included files, by name, with their numbers.
    read: HashMap<String, (usize, Rc<Parsed>)>,
    /// The names of the files one is in.
    inside: Vec<String>,
    level: i64,
    /// The material that holds, and the file that said so.
    finish: Option<(Finish, Rc<str>)>,
    /// The nodes one is in, the root first.
    nodes: Vec<u32>,
    looks: Looks,
    /// Meshes by file, patch, and the materials its looks come to.
    meshes: HashMap<(usize, u32, Vec<u32>), u32>,
    rounds: Rounds,
    /// Nodes and the names they follow.
    moving: Vec<(u32, String)>,
    /// Lights without a colour of their own.
    plain_lights: Vec<usize>,
    /// Lights and the names they follow.
    moving_lights: Vec<(u32, String)>,
    /// Motions by name: of several the last.
    motions: HashMap<String, u32>,
    /// What the scene may still unfold to.
    left: u64,
}

impl Placing<'_> {
    /// Carries a file out. The scene's own has number 0.
    fn file(&mut self, parsed: &Parsed, file: &str, number: usize) -> Result<(), SceneError> {
        for statement in &parsed.statements {
            self.spend(1, file)?;
            match statement {
                Statement::View(Some(view)) => self.scene.view = Some(**view),
                Statement::View(None) => {
                    let warning = "a view without a direction, or upright along it, is left out";
                    self.scene.warnings.push(warning.to_owned());
                }
                Statement::Background(colour) => self.scene.background = Some(*colour),
                Statement::Ambient(colour) => self.scene.ambient = Some(*colour),
                Statement::Light(light) => self.light(light),
                Statement::Detail(level) => self.level = *level,
                Statement::Include(include) => {
                    if include.level <= self.level {
                        self.include(&include.name, file, include.place)?;
                    }
                }
                Statement::Finish(finish) => self.finish = Some((**finish, parsed.stem.clone())),
                Statement::Open(transform) => self.open("", **transform, file)?,
                Statement::OpenMoving(name) => {
                    self.open(name, Affine3A::IDENTITY, file)?;
                    self.moving.push((self.here(), name.clone()));
                }
                Statement::Close => {
                    self.nodes.pop();
                }
                Statement::Patch(patch) => self.patch(parsed, number, *patch, file)?,
                Statement::Round(round) => {
                    let look = Look::default();
                    let holds = self.finish.as_ref();
                    let (source, scene) = (self.source, &mut self.scene);
                    let material = self.looks.material(&look, holds, &parsed.stem, source, scene);
                    self.rounds.add(self.here(), *round, Some(material).filter(|number| *number != UNKNOWN));
                }
                Statement::Keys(motion) => self.keys(motion),
                Statement::Frames(start, end, frames) => {
                    let animation = &mut self.scene.animation;
                    (animation.start, animation.end, animation.frames) = (*start, *end, *frames);
                }
            }
        }
        Ok(())
    }

    /// The innermost node one is in.
    fn here(&self) -> u32 {
        self.nodes[self.nodes.len() - 1]
    }

    fn spend(&mut self, amount: u64, file: &str) -> Result<(), SceneError> {
        let left = self.left.checked_sub(amount).ok_or_else(|| {
            let expected = format!(
                "at most {MOST_REPEATED} vertices, triangles and statements more than are spelled out"
            );
            SceneError::malformed(
                file,
                "document",
                "files included again and again make too large a scene",
                expected,
            )
        });
        self.left = left?;
        Ok(())
    }

    fn light(&mut self, light: &Light) {
        let lights = &mut self.scene.lights;
        if let Some(name) = &light.name {
            self.moving_lights.push((lights.len() as u32, name.clone()));
        }
        if light.colour.is_none() {
            self.plain_lights.push(lights.len());
        }
        lights.push(PointLight { position: light.position, colour: light.colour.unwrap_or(Vec3::ONE) });
    }

    fn open(&mut self, name: &str, transform: Affine3A, file: &str) -> Result<(), SceneError> {
        self.spend(NODE, file)?;
        let node = self.scene.add_node(Some(self.here()), name, transform, None);
        self.nodes.push(node);
        Ok(())
    }

    fn keys(&mut self, motion: &Motion) {
        let motions = &mut self.scene.animation.motions;
        match self.motions.get(&motion.name) {
            Some(number) => motions[*number as usize] = motion.clone(),
            None => {
                self.motions.insert(motion.name.clone(), motions.len() as u32);
                motions.push(motion.clone());
            }
        }
    }

    fn include(&mut self, name: &str, file: &str, place: (u32, u32)) -> Result<(), SceneError> {
        let wrong = |found: String, expected: &str| {
            let (line, column) = place;
            SceneError::malformed(file, format!("line {line}, column {column}"), found, expected)
        };
        let inside =
            within(name).ok_or_else(|| wrong(format!("{name:?}"), "a file in the scene's folder"))?;
        if self.inside.contains(&inside) {
            return Err(wrong(
                format!("{name:?} includes itself in the end"),
                "an end to what files include",
            ));
        }
        if self.inside.len() == MOST_FILES_DEEP {
            let found = format!("{name:?}, a file in {MOST_FILES_DEEP} others");
            return Err(wrong(found, "files that include one another less deep"));
        }
        let path = self.source.beside(&inside).display().to_string();
        let (number, parsed) = match self.read.get(&inside) {
            Some(known) => known.clone(),
            None => {
                let bytes = self.source.neighbour(&inside).map_err(|error| {
                    wrong(
                        format!("{name:?} cannot be read as {path}: {error}"),
                        "a file in the scene's folder",
                    )
                })?;
                self.left += bytes.len() as u64;
                let stem = Path::new(&inside).file_stem().unwrap_or_default().to_string_lossy();
                let known = (self.read.len() + 1, Rc::new(parse(&path, &stem, &bytes)?));
                self.scene.warnings.extend_from_slice(&known.1.warnings);
                self.read.insert(inside.clone(), known.clone());
                known
            }
        };
        self.inside.push(inside);
        self.file(&parsed, &path, number)?;
        self.inside.pop();
        Ok(())
    }

    /// Places a patch here, as the mesh that it is elsewhere if it looks the same.
    fn patch(&mut self, parsed: &Parsed, file: usize, number: u32, path: &str) -> Result<(), SceneError> {
        let patch = &parsed.patches[number as usize];
        let (looks, holds, scene) = (&mut self.looks, self.finish.as_ref(), &mut self.scene);
        let material = |look| looks.material(look, holds, &parsed.stem, self.source, scene);
        let materials: Vec<u32> = patch.looks.iter().map(material).collect();
        let key = (file, number, materials);
        let mesh = match self.meshes.get(&key) {
            Some(mesh) => *mesh,
            None => {
                let frames = patch.keys.len() as u64 + 1;
                self.spend(frames * patch.positions.len() as u64 + patch.triangles.len() as u64, path)?;
                let mesh = self.scene.add_mesh(patch.mesh(&parsed.stem, &key.2));
                if !patch.keys.is_empty() {
                    self.scene.animation.bends.push(Bend { mesh, keys: patch.keys.clone() });
                }
                self.meshes.insert(key, mesh);
                mesh
            }
        };
        self.spend(NODE, path)?;
        self.scene.add_node(Some(self.here()), &*parsed.stem, Affine3A::IDENTITY, Some(mesh));
        Ok(())
    }

    /// What can be said only once all has been read.
    fn finish(mut self) -> Scene {
        let follow = |list: Vec<(u32, String)>| {
            let motion = |(what, name): (u32, String)| Some((what, *self.motions.get(&name)?));
            list.into_iter().filter_map(motion).collect()
        };
        self.scene.animation.followers = follow(self.moving);
        self.scene.animation.lights = follow(self.moving_lights);
        self.scene.animation.camera = self.motions.get(CAMERA).copied();
        self.rounds.place(&mut self.scene);
        self.scene
    }
}

impl Patch {
    /// As a mesh whose looks have come to these materials.
    fn mesh(&self, name: &str, materials: &[u32]) -> Mesh {
        let each = |look: &u32| materials[*look as usize];
        let materials = match materials {
            [UNKNOWN] => Materials::Unknown,
            [material] => Materials::One(*material),
            _ => Materials::from_each(self.look_of.iter().map(each).collect()),
        };
        let shading =
            Shading { materials, normals: self.normals.clone(), coordinates: self.coordinates.clone() };
        Mesh { shading, ..Mesh::new(name, self.positions.clone(), self.triangles.clone()) }
    }
}

/// A file's name as it lies in a folder, or none if it leads out of it.
pub(super) fn within(name: &str) -> Option<String> {
    // Windows wrote some of these files.
    let name = name.replace('\\', "/");
    let mut parts = Vec::new();
    for part in Path::new(&name).components() {
        match part {
            Component::Normal(part) => parts.push(part.to_str()?),
            Component::CurDir => {}
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    (!parts.is_empty()).then(|| parts.join("/"))
}
