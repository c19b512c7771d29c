//! Where rays meet shapes.

mod cone;
mod sphere;

pub use cone::{Cone, cone};
pub use sphere::sphere;

/// The lesser of two roots that lies on the ray, rounded to f32.
fn first_within(ray: &super::Ray, roots: [f64; 2]) -> Option<f32> {
    let [a, b] = roots.map(|t| t as f32);
    let within = |t: &f32| *t >= ray.near && *t <= ray.far;
    [a.min(b), a.max(b)].into_iter().find(within)
}
