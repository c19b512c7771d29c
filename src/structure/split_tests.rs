//! Splitting against a plain, slow version of itself, and on everything that could make it go wrong.

use super::*;
use crate::scene::{SplitMix64, by_name};

fn number(most: usize) -> NonZeroUsize {
    NonZeroUsize::new(most).expect("not 0")
}

fn soup(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Mesh {
    let positions: Vec<Vec3> = triangles.into_iter().flatten().collect();
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::new("soup", positions, triangles)
}

/// Small triangles here and there, clustered more and more towards the origin.
fn random(count: usize, seed: u64) -> Mesh {
    let mut random = SplitMix64::new(seed);
    let mut point = |reach: f64| Vec3::from([(); 3].map(|()| random.between(-reach, reach) as f32));
    soup((0..count).map(|i| {
        let middle = point(10.0 / (1.0 + i as f64 / 50.0));
        [(); 3].map(|()| middle + point(0.2))
    }))
}

/// The oracle: parts as lists, boxes taken anew from all vertices, no threads. None where a median is due.
fn plain(
    mesh: &Mesh,
    part: Vec<[u32; 3]>,
    most: usize,
    leaves: &mut Vec<(Vec<[u32; 3]>, Aabb)>,
) -> Option<()> {
    let at = |vertex: u32| mesh.positions[vertex as usize];
    let bounds = Aabb::of_points(part.iter().flatten().map(|vertex| at(*vertex)));
    if part.len() <= most {
        leaves.push((part, bounds));
        return Some(());
    }
    let size = bounds.size().to_array();
    let axis = (0..3).rev().max_by(|a, b| size[*a].total_cmp(&size[*b])).expect("three axes");
    let plane = bounds.centre()[axis];
    let middle = |[a, b, c]: &[u32; 3]| (at(*a)[axis] + at(*b)[axis] + at(*c)[axis]) * (1.0 / 3.0);
    let (one, other): (Vec<_>, Vec<_>) = part.into_iter().partition(|triangle| middle(triangle) < plane);
    if one.is_empty() || other.is_empty() {
        return None;
    }
    plain(mesh, one, most, leaves)?;
    plain(mesh, other, most, leaves)
}

/// What must hold of every split, whatever the mesh.
fn check(mesh: &Mesh, most: usize) -> Split {
    let split = Split::new(mesh, number(most)).unwrap();
    let mut next = 0;
    for leaf in &split.leaves {
        assert_eq!(leaf.triangles.start, next);
        next = leaf.triangles.end;
        let triangles = &split.triangles[leaf.triangles.start as usize..next as usize];
        assert!((1..=most).contains(&triangles.len()), "a leaf of {}", triangles.len());
        let places = triangles.iter().flatten().map(|vertex| mesh.positions[*vertex as usize]);
        assert_eq!(leaf.bounds, Aabb::of_points(places));
    }
    assert_eq!(next as usize, mesh.triangles.len());
    let sorted = |mut triangles: Vec<[u32; 3]>| {
        triangles.sort_unstable();
        triangles
    };
    assert_eq!(sorted(split.triangles.clone()), sorted(mesh.triangles.clone()));
    let count = mesh.triangles.len().max(1);
    let most_depth = super::super::midpoint::most_midpoints(count, most) + count.ilog2() + 2;
    assert!(split.depth <= most_depth, "depth {} of {count} triangles", split.depth);
    split
}

#[test]
fn splits_are_those_of_the_oracle_on_any_number_of_threads() {
    let pools =
        [1, 2, 5].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap());
    let dragon = by_name("dragon").unwrap().meshes.remove(0);
    for (mesh, mosts) in [(random(20_000, 1), vec![1, 7, 500, 30_000]), (dragon, vec![349, 5000])] {
        for most in mosts {
            let split = check(&mesh, most);
            for pool in &pools {
                assert_eq!(pool.install(|| Split::new(&mesh, number(most)).unwrap()), split);
            }
            let mut expected = Vec::new();
            let all_midpoints = plain(&mesh, mesh.triangles.clone(), most, &mut expected).is_some();
            assert_eq!(all_midpoints, split.medians == 0, "at {most}: {} medians", split.medians);
            if all_midpoints {
                let of_leaf = |leaf: &Leaf| {
                    let range = leaf.triangles.start as usize..leaf.triangles.end as usize;
                    (split.triangles[range].to_vec(), leaf.bounds)
                };
                assert!(split.leaves.iter().map(of_leaf).eq(expected), "at {most}");
            }
        }
    }
}

#[test]
fn centroids_that_no_plane_parts_are_halved_at_the_median() {
    let same = soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 1000]);
    let split = check(&same, 10);
    // Halves of halves: 1000 / 2^7 is the first that fits.
    assert_eq!((split.leaves.len(), split.medians, split.depth), (128, 127, 8));
    let spokes = by_name("equal-centroids").unwrap().meshes.remove(0);
    let split = check(&spokes, 64);
    assert_eq!((split.leaves.len(), split.medians), (64, 63));
    // A point is the least there can be.
    check(&soup(vec![[Vec3::splat(1e6); 3]; 100]), 1);
}

#[test]
fn outliers_do_not_make_the_tree_deep() {
    // Each lies twice as far out as the one before: a midpoint takes off one at a time.
    let chain = |count: i32| soup((0..count).map(|i| [Vec3::X * 1.5f32.powi(i); 3]));
    let split = check(&chain(200), 1);
    assert!(split.medians > 0 && split.depth < 40, "{} medians, depth {}", split.medians, split.depth);
    let outlier = by_name("far-outlier").unwrap().meshes.remove(0);
    let split = check(&outlier, 5000);
    assert_eq!(split.leaves.iter().filter(|leaf| leaf.triangles.len() == 1).count(), 1);
    // Long needles all as long as the box: only the other axes tell them apart, and the median finds those.
    let needles = (0..100).map(|i| {
        let aside = Vec3::new(0.0, i as f32 * 0.01, 0.0);
        [Vec3::ZERO + aside, Vec3::X * 100.0 + aside, Vec3::X * 50.0 + aside]
    });
    let split = check(&soup(needles), 10);
    assert!(split.leaves.iter().all(|leaf| leaf.bounds.size().y < 0.1));
}

#[test]
fn few_triangles_huge_ones_and_far_ones() {
    assert_eq!(Split::new(&soup([]), number(5)).unwrap(), Split::default());
    assert_eq!(check(&random(1, 2), 1).leaves.len(), 1);
    assert_eq!(check(&random(2, 2), 1).leaves.len(), 2);
    assert_eq!(check(&random(500, 2), usize::MAX).leaves.len(), 1);
    let mut far = random(3000, 3);
    far.positions.iter_mut().for_each(|place| *place += Vec3::splat(1e6));
    check(&far, 3);
    let mut huge = random(3000, 4);
    huge.positions.iter_mut().for_each(|place| *place = (*place * f32::MAX).clamp(Vec3::MIN, Vec3::MAX));
    check(&huge, 3);
}

#[test]
fn faults_are_named() {
    let message = |change: fn(&mut Mesh)| {
        let mut mesh = random(10_000, 5);
        change(&mut mesh);
        Split::new(&mesh, number(3)).unwrap_err().to_string()
    };
    let message_of_index = message(|mesh| mesh.triangles[7777][1] = 30_000);
    assert!(message_of_index.contains("\"soup\", triangle 7777") && message_of_index.contains("below 30000"));
    assert!(message(|mesh| mesh.positions[12].y = f32::NAN).contains("vertex 12"));
    assert!(message(|mesh| mesh.positions[29_999].z = f32::INFINITY).contains("vertex 29999"));
}
