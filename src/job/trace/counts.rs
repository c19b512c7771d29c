//! How many rays a picture took.

/// Rays traced, by class (P3-11), and how deep they went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// From the eye: one a pixel.
    pub eye: u64,
    /// To a light.
    pub shadow: u64,
    /// Mirrored.
    pub reflection: u64,
    /// Let through, bent or not.
    pub refraction: u64,
    /// The most bounces between the eye and a surface that was seen.
    pub deepest: u32,
}

impl Counts {
    /// All rays.
    pub fn rays(&self) -> u64 {
        self.eye + self.shadow + self.reflection + self.refraction
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.eye += other.eye;
        self.shadow += other.shadow;
        self.reflection += other.reflection;
        self.refraction += other.refraction;
        self.deepest = self.deepest.max(other.deepest);
    }
}
