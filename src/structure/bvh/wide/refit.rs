//! A wide hierarchy over triangles that have moved.

use super::layout::{Child, WIDTH};
use super::{Block, WideBvh};
use crate::geometry::Aabb;
use crate::geometry::hit::{Scale, TriangleTest};
use glam::Vec3;

impl<T: TriangleTest> WideBvh<T> {
    /// Takes in where its triangles are now, in metres: the same nodes, with new boxes from the leaves up (Ize ch. 7.6).
    /// What it tells is what one built anew tells, bit for bit. Triangles that could not be met when it was built, as
    /// they had a corner that was not finite, cannot be met now either.
    ///
    /// # Panics
    /// If there are fewer triangles than it was built over.
    pub fn refit(&mut self, triangles: &[[Vec3; 3]]) {
        let scale = Scale::of(triangles.iter().flatten().copied());
        self.scale = scale;
        // Children come after their parents.
        for at in (0..self.nodes.len()).rev() {
            for i in 0..WIDTH {
                let child = self.nodes[at].children[i];
                if child == Child::NONE {
                    continue;
                }
                let around = if child.blocks() == 0 {
                    self.nodes[child.index()].boxes().fold(Aabb::EMPTY, Aabb::union)
                } else {
                    let blocks = &mut self.blocks[child.index()..child.index() + child.blocks()];
                    blocks
                        .iter_mut()
                        .fold(Aabb::EMPTY, |around, block| around.union(renew(block, triangles, scale)))
                };
                self.nodes[at].set(i, &around, child);
            }
        }
    }
}

/// Puts a block's triangles where they are now, and tells a box around those that can be met.
fn renew(block: &mut Block, triangles: &[[Vec3; 3]], scale: Scale) -> Aabb {
    let mut around = Aabb::EMPTY;
    for i in 0..block.items.len() {
        let item = block.items[i];
        if item == u32::MAX {
            continue;
        }
        let corners = triangles[item as usize];
        if corners.iter().all(|corner| corner.is_finite()) {
            let corners = corners.map(|corner| scale.point(corner));
            around = around.union(Aabb::of_points(corners));
            block.set(i, corners, item);
        } else {
            block.set(i, [Vec3::NAN; 3], item);
        }
    }
    around
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use crate::scene::SplitMix64;
    use crate::structure::bvh::build::{BUILDERS, Builder, Input, Settings};
    use crate::structure::bvh::{BinaryBvh, Intersector};

    fn built(name: &str, triangles: &[[Vec3; 3]]) -> WideBvh {
        let boxes: Vec<Aabb> = triangles.iter().map(|corners| Aabb::of_points(*corners)).collect();
        let mut binary = BinaryBvh::default();
        let mut builder = Builder::new(name, &Settings::default()).unwrap();
        builder.build(&Input { boxes: &boxes, triangles: Some(triangles) }, &mut binary).unwrap();
        WideBvh::new(&binary, triangles)
    }

    /// Triangles anywhere in a cube of so many metres, all of much the same size.
    fn anywhere(random: &mut SplitMix64, count: usize, side: f64) -> Vec<[Vec3; 3]> {
        let mut point =
            |side: f64| Vec3::from_array(std::array::from_fn(|_| random.between(-side, side) as f32));
        (0..count)
            .map(|_| {
                let at = point(side);
                [at, at + point(0.3), at + point(0.3)]
            })
            .collect()
    }

    #[test]
    fn a_refitted_one_tells_what_a_new_one_tells() {
        let mut random = SplitMix64::new(12);
        for about in BUILDERS {
            for count in [0, 1, 5, 300] {
                let before = anywhere(&mut random, count, 2.0);
                let mut kept = built(about.name, &before);
                // Farther apart, far from where they were, and of another scale altogether.
                for (side, off) in [(5.0, 0.0), (2.0, 1e6), (2.0, 0.0)] {
                    let mut now = anywhere(&mut random, count, side);
                    now.iter_mut().flatten().for_each(|corner| *corner += off);
                    kept.refit(&now);
                    let anew = built(about.name, &now);
                    let rays = anywhere(&mut random, 300, 1.2 * side);
                    for [from, to, _] in rays {
                        let to = now
                            .first()
                            .map_or(to, |first| (first[0] + first[1] + first[2]) / 3.0 + (to - from));
                        let ray = Ray::new(from + off, to - from - off);
                        let found = kept.closest(&ray);
                        assert_eq!(found, anew.closest(&ray), "{} {count} {side} {off}", about.name);
                        assert_eq!(kept.occluded(&ray), found.is_some());
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_no_longer_finite_is_not_met_and_hides_nothing_else() {
        let mut triangles = anywhere(&mut SplitMix64::new(3), 40, 1.0);
        let mut kept = built("binned_sah", &triangles);
        for bad in [f32::NAN, f32::INFINITY] {
            triangles[7][1].y = bad;
            kept.refit(&triangles);
            for (number, [a, b, c]) in triangles.iter().enumerate().filter(|(number, _)| *number != 7) {
                let middle = (*a + *b + *c) / 3.0;
                let normal = (*b - *a).cross(*c - *a).normalize();
                let hit = kept.closest(&Ray::new(middle + normal * 1e-2, -normal));
                assert!(hit.is_some_and(|hit| hit.item != 7), "{number}");
            }
        }
    }

    #[test]
    fn the_expected_cost_grows_as_neighbours_part_and_shrinks_when_it_is_built_anew() {
        let mut random = SplitMix64::new(5);
        let before = anywhere(&mut random, 2000, 10.0);
        let mut kept = built("binned_sah", &before);
        let fresh = kept.expected_cost();
        // The same triangles, each where another was.
        let mut shuffled = before.clone();
        shuffled.rotate_left(700);
        kept.refit(&shuffled);
        assert!(kept.expected_cost() > 5.0 * fresh, "{} after {fresh}", kept.expected_cost());
        let anew = built("binned_sah", &shuffled).expected_cost();
        assert!((anew - fresh).abs() < 0.1 * fresh, "{anew}, {fresh}");
        assert_eq!(built("binned_sah", &[]).expected_cost(), 0.0);
        let points = vec![[Vec3::ONE; 3]; 100];
        assert!(built("binned_sah", &points).expected_cost().is_finite());
    }
}
