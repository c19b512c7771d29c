//! Generated scenes. The list is the table of contents.

use super::{Scene, SceneError, names};

mod bart;
mod cloth;
mod corner;
mod cylinders;
mod dragons;
mod factory;
mod geodesic;
mod noise_sphere;
mod place;
mod robot;
mod room;
mod shapes;
mod shell;
mod spheres;

pub(super) use geodesic::geodesic;
pub(super) use shapes::{cuboid, cylinder};

/// A scene made by a program.
pub struct Generator {
    /// Name: in the command line, in rows, in legends.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    generate: fn() -> Scene,
    aisles: fn() -> Aisles,
}

impl Generator {
    /// Makes the scene; the same one each time.
    pub fn generate(&self) -> Scene {
        (self.generate)()
    }

    /// Where a person can walk in it.
    pub fn aisles(&self) -> Aisles {
        (self.aisles)()
    }
}

/// Where a person can walk in a generated scene: straight aisles along x and along z that all cross. What is
/// no hall but one thing to look at from outside has none.
#[derive(Clone, Debug, PartialEq)]
pub struct Aisles {
    /// Where the aisles along z lie: their x, in metres, least first.
    pub x: Vec<f32>,
    /// Where the aisles along x lie: their z, in metres, least first.
    pub z: Vec<f32>,
    /// Far plane that takes in the whole hall from anywhere in it, in metres.
    pub far: f32,
}

impl Aisles {
    /// Nowhere to walk.
    const NONE: Self = Self { x: Vec::new(), z: Vec::new(), far: 0.0 };

    /// Whether there is nowhere to walk.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty() || self.z.is_empty()
    }
}

/// All generators.
pub const GENERATORS: &[Generator] = &[
    factory::LARGE,
    factory::MEDIUM,
    factory::SMALL,
    factory::MODEL_1,
    factory::MODEL_2,
    factory::MODEL_3,
    dragons::ONE,
    dragons::SPLIT,
    dragons::PACKED_SIXTY,
    dragons::POMPEII,
    dragons::SPOKED,
    dragons::OUTLIER,
    robot::ROBOT,
    shell::OUTER,
    shell::FIVE_PERCENT,
    shell::ONE_PERCENT,
    cloth::CLOTH,
    room::ROOM,
    corner::CORNER,
    spheres::THOUSANDS,
    spheres::MILLION,
    spheres::ALL,
    noise_sphere::NOISE_SPHERE,
    cylinders::SIDES_50,
    cylinders::SIDES_150,
    cylinders::SIDES_500,
    cylinders::SIDES_1000,
    cylinders::SIDES_5000,
    bart::K3,
    bart::K4,
    bart::K5,
    bart::K6,
    bart::K7,
    bart::K8,
    bart::ROBOTS,
    bart::KITCHEN,
    bart::ONE,
    bart::TWO,
    bart::THREE,
    bart::FOUR,
    bart::FIVE,
    bart::SIX,
    bart::SEVEN,
    bart::EIGHT,
    bart::NINE,
    bart::TEN,
    bart::S1,
    bart::S2,
    bart::S3,
    bart::S4,
    bart::S5,
    bart::S5_SMALL,
    bart::S6,
    bart::S7,
    bart::S8,
];

/// Makes a scene by its name.
///
/// # Errors
/// [`SceneError::UnknownName`], listing the near names.
pub fn by_name(name: &str) -> Result<Scene, SceneError> {
    generator(name).map(Generator::generate)
}

/// The generator of that name.
pub(super) fn generator(name: &str) -> Result<&'static Generator, SceneError> {
    GENERATORS.iter().find(|generator| generator.name == name).ok_or_else(|| SceneError::UnknownName {
        name: name.to_string(),
        advice: names::advice(name, GENERATORS.iter().map(|generator| generator.name)),
    })
}
