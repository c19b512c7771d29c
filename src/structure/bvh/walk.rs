//! How a ray goes through a binary hierarchy, whatever its items are.

use super::BinaryBvh;
use crate::geometry::{Aabb, Ray};
use glam::DVec3;

/// Bound on the rounding of a distance, in f64, and on that of an item's own test, as a share of it.
const SLACK: f64 = 1e-9;

impl BinaryBvh {
    /// Goes through the items in whose leaves a ray may end, nearer leaves first. `item` is told an item and how far the
    /// ray still reaches, in its `t`, and answers how far it reaches from then on; below the ray's `near`, no further
    /// item is asked about. A box is passed over only if an item within it, by the box's own bounds, cannot be met.
    pub fn walk(&self, ray: &Ray, mut item: impl FnMut(u32, f32) -> f32) {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let inverse = direction.recip();
        if self.nodes.is_empty() || direction.is_nan() || origin.is_nan() || direction == DVec3::ZERO {
            return;
        }
        let mut far = ray.far;
        let near = f64::from(ray.near);
        let enter = |bounds: &Aabb, far: f32| {
            let (enters, leaves) = between(bounds, origin, inverse);
            (enters <= leaves && leaves >= near && enters <= f64::from(far)).then_some(enters)
        };
        let mut stack: Vec<(f64, u32)> =
            enter(&self.nodes[0].bounds, far).map(|at| (at, 0)).into_iter().collect();
        while let Some((at, number)) = stack.pop() {
            if at > f64::from(far) {
                continue;
            }
            let node = &self.nodes[number as usize];
            if node.is_leaf() {
                for place in node.first..node.first + node.count {
                    far = item(self.order[place as usize], far);
                }
                if far < ray.near {
                    return;
                }
                continue;
            }
            let mut children = [node.first, node.first + 1]
                .map(|child| (enter(&self.nodes[child as usize].bounds, far), child));
            if children[0].0 < children[1].0 {
                children.swap(0, 1);
            }
            stack.extend(children.into_iter().filter_map(|(at, child)| Some((at?, child))));
        }
    }
}

/// From where to where a ray is within a box, not less than it is.
fn between(bounds: &Aabb, origin: DVec3, inverse: DVec3) -> (f64, f64) {
    let [a, b] = [bounds.min, bounds.max].map(|corner| (corner.as_dvec3() - origin) * inverse);
    // In a plane that it is parallel to, a ray gets NaN, which bounds nothing: the other argument is taken.
    let (mut enters, mut leaves) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let (first, last) = if inverse[axis] < 0.0 { (b[axis], a[axis]) } else { (a[axis], b[axis]) };
        enters = enters.max(first - first.abs() * SLACK);
        leaves = leaves.min(last + last.abs() * SLACK);
    }
    (enters, leaves)
}

#[cfg(test)]
mod tests {
    use super::super::build::{Builder, Input, Settings};
    use super::*;
    use glam::Vec3;

    fn boxes(count: usize) -> Vec<Aabb> {
        let mut random = crate::scene::SplitMix64::new(3);
        let mut draw = || Vec3::from_array(std::array::from_fn(|_| random.between(0.0, 1.0) as f32));
        (0..count)
            .map(|_| {
                let at = draw() * 10.0;
                Aabb { min: at, max: at + draw() }
            })
            .collect()
    }

    /// The items a walk asks about when nothing shortens the ray.
    fn asked(bvh: &BinaryBvh, ray: &Ray) -> Vec<u32> {
        let mut asked = Vec::new();
        bvh.walk(ray, |item, far| {
            asked.push(item);
            far
        });
        asked.sort_unstable();
        asked
    }

    #[test]
    fn every_box_on_the_way_is_asked_about_and_the_nearest_first() {
        let boxes = boxes(500);
        let mut bvh = BinaryBvh::default();
        let settings = Settings { most_in_leaf: 1, ..Settings::default() };
        Builder::new("binned_sah", &settings).unwrap().build(&Input::of(&boxes), &mut bvh).unwrap();
        let directions = [Vec3::X, -Vec3::Y, Vec3::new(1.0, 0.3, -0.2), Vec3::new(0.0, -1e-20, 1.0)];
        for (number, direction) in (0..400).flat_map(|number| directions.map(|direction| (number, direction)))
        {
            let aim = boxes[number].centre();
            let ray = Ray::new(aim - direction.normalize() * 20.0, direction);
            let (origin, inverse) = (ray.origin.as_dvec3(), ray.direction.as_dvec3().recip());
            let meets = |bounds: &Aabb| {
                let (enters, leaves) = between(bounds, origin, inverse);
                enters <= leaves && leaves >= 0.0
            };
            let all = asked(&bvh, &ray);
            for (item, _) in boxes.iter().enumerate().filter(|(_, bounds)| meets(bounds)) {
                assert!(all.contains(&(item as u32)), "{item} {ray:?}");
            }
            assert!(all.contains(&(number as u32)), "{number} {ray:?}");
            // A ray that ends in the first item does not get to what lies behind it.
            let mut count = 0;
            bvh.walk(&ray, |_, _| {
                count += 1;
                -1.0
            });
            assert_eq!(count, 1);
        }
    }

    #[test]
    fn nothing_is_asked_of_what_is_not() {
        let ray = Ray::new(Vec3::ZERO, Vec3::X);
        assert!(asked(&BinaryBvh::default(), &ray).is_empty());
        let boxes = boxes(3);
        let mut bvh = BinaryBvh::default();
        Builder::new("binned_sah", &Settings::default())
            .unwrap()
            .build(&Input::of(&boxes), &mut bvh)
            .unwrap();
        for bad in [Vec3::ZERO, Vec3::NAN] {
            assert!(asked(&bvh, &Ray::new(Vec3::splat(0.5), bad)).is_empty());
        }
        assert!(asked(&bvh, &Ray::new(Vec3::NAN, Vec3::X)).is_empty());
        assert!(asked(&bvh, &Ray { far: f32::NAN, ..Ray::new(boxes[0].centre(), Vec3::X) }).is_empty());
    }
}
