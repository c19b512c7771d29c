use super::*;
use crate::structure::bvh::refit;
use lanes::Unit;

/// Numbers that look random, from 0 to 1.
pub(super) fn noise(seed: u64) -> impl FnMut() -> f32 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as f32 / (1 << 24) as f32
    }
}

pub(super) fn scattered(count: usize, seed: u64) -> Vec<[Vec3; 3]> {
    let mut next = noise(seed);
    let mut point = |size: f32| Vec3::new(next(), next(), next()) * size;
    (0..count)
        .map(|_| {
            let at = point(10.0);
            [at, at + point(0.5), at + point(0.5)]
        })
        .collect()
}

fn boxes_of(triangles: &[[Vec3; 3]]) -> Vec<Aabb> {
    triangles.iter().map(|corners| Aabb::of_points(*corners)).collect()
}

fn at(x: f32, y: f32, z: f32, size: f32) -> Aabb {
    Aabb { min: Vec3::new(x, y, z), max: Vec3::new(x, y, z) + size }
}

/// Boxes that have made builders fail, by what is odd about them.
pub(super) fn nasty() -> Vec<(&'static str, Vec<Aabb>)> {
    let plain = boxes_of(&scattered(300, 7));
    let moved = |by: f32| plain.iter().map(|b| Aabb { min: b.min + by, max: b.max + by }).collect();
    let scaled = |by: f32| plain.iter().map(|b| Aabb { min: b.min * by, max: b.max * by }).collect();
    let mut one_infinite: Vec<Aabb> = plain.clone();
    one_infinite[17] = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
    one_infinite[40].max.y = f32::INFINITY;
    let mut one_huge: Vec<Aabb> = plain.clone();
    one_huge[5] = Aabb { min: Vec3::splat(f32::MIN), max: Vec3::splat(f32::MAX) };
    vec![
        ("none", vec![]),
        ("one", vec![at(1.0, 2.0, 3.0, 1.0)]),
        ("two", vec![at(0.0, 0.0, 0.0, 1.0), at(5.0, 0.0, 0.0, 1.0)]),
        ("one point", vec![at(3.0, 3.0, 3.0, 0.0)]),
        ("all in one place", vec![at(1.0, 1.0, 1.0, 2.0); 1000]),
        ("all one point", vec![at(0.0, 0.0, 0.0, 0.0); 100]),
        (
            "one middle, many sizes",
            (1..200).map(|i| at(-(i as f32), -(i as f32), -(i as f32), 2.0 * i as f32)).collect(),
        ),
        ("a line", (0..500).map(|i| at(i as f32, 0.0, 0.0, 0.0)).collect()),
        ("powers of two", (-120..120).map(|i| at((i as f32).exp2(), 0.0, 0.0, 0.0)).collect()),
        ("far away", moved(1e7)),
        ("farther still", moved(1e15)),
        ("huge", scaled(1e36)),
        ("tiny", scaled(1e-38)),
        ("subnormal", scaled(1e-43)),
        ("one infinite among others", one_infinite),
        ("one huge among others", one_huge),
        ("all infinite", vec![Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY }; 20]),
        ("infinitely far", vec![Aabb { min: Vec3::splat(f32::MAX), max: Vec3::INFINITY }; 20]),
        ("twice each", plain.iter().chain(&plain).copied().collect()),
        ("plain", plain),
    ]
}

/// Builds over boxes alone by every builder.
fn each_builder(settings: &Settings, mut test: impl FnMut(&str, &mut Builder)) {
    for about in BUILDERS {
        test(about.name, &mut Builder::new(about.name, settings).expect("it is in the list"));
    }
}

#[test]
fn every_builder_survives_nasty_boxes() {
    for settings in [
        Settings::default(),
        Settings { bins: 2, most_in_leaf: 1, median_leaf: 1, cluster: 1, ..Settings::default() },
        Settings { bins: MOST_BINS, most_in_leaf: 4, step_cost: 0.0, cluster: 32, ..Settings::default() },
    ] {
        each_builder(&settings, |name, builder| {
            // One after the other with the same builder: nothing may be left of the one before.
            for (what, boxes) in nasty() {
                let mut bvh = BinaryBvh::default();
                builder
                    .build(&Input::of(&boxes), &mut bvh)
                    .unwrap_or_else(|error| panic!("{name}, {what}: {error}"));
                bvh.validate(&boxes).unwrap_or_else(|error| panic!("{name}, {what}: {error}"));
                let told = bvh.statistics();
                let most = settings.most_in_leaf.max(settings.median_leaf);
                assert!(told.leaves_by_items.len() <= most + 1, "{name}, {what}: {told:?}");
                assert!(told.depth <= MOST_DEPTH, "{name}, {what}: {told:?}");
                assert_eq!(told.nodes, (2 * told.leaves).saturating_sub(1));
                let mut again = bvh.clone();
                builder.build(&Input::of(&boxes), &mut again).expect("it did before");
                assert_eq!(again, bvh, "{name}, {what}: built twice");
            }
        });
    }
}

#[test]
fn a_box_that_is_none_is_told() {
    let plain = boxes_of(&scattered(100, 3));
    let bad = [
        Aabb { min: Vec3::new(0.0, f32::NAN, 0.0), max: Vec3::ONE },
        Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 1.0, f32::NAN) },
        Aabb::EMPTY,
        Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, -1.0, 1.0) },
    ];
    each_builder(&Settings::default(), |name, builder| {
        for bounds in bad {
            let mut boxes = plain.clone();
            boxes[63] = bounds;
            boxes[80] = bounds;
            let error = builder.build(&Input::of(&boxes), &mut BinaryBvh::default()).unwrap_err();
            assert!(matches!(error, BuildError::NoBox { item: 63, .. }), "{name}: {error}");
        }
        let (two, three) = (&plain[..2], scattered(3, 1));
        let input = Input { boxes: two, triangles: Some(&three) };
        let error = builder.build(&input, &mut BinaryBvh::default()).unwrap_err();
        assert_eq!(error, BuildError::Triangles { triangles: 3, boxes: 2 });
    });
}

#[test]
fn senseless_settings_are_told() {
    let plain = Settings::default;
    for (settings, named) in [
        (Settings { bins: 1, ..plain() }, "bins"),
        (Settings { bins: MOST_BINS + 1, ..plain() }, "bins"),
        (Settings { most_in_leaf: 0, ..plain() }, "most_in_leaf"),
        (Settings { median_leaf: 0, ..plain() }, "median_leaf"),
        (Settings { cluster: 33, ..plain() }, "cluster"),
        (Settings { step_cost: f32::NAN, ..plain() }, "step_cost"),
        (Settings { item_cost: -1.0, ..plain() }, "item_cost"),
    ] {
        match Builder::new("binned_sah", &settings).err() {
            Some(BuildError::Setting { setting, .. }) => assert_eq!(setting, named),
            other => panic!("{named}: {other:?}"),
        }
    }
    let error = Builder::new("sah", &plain()).err().expect("there is none of that name");
    assert!(error.to_string().contains("binned_sah"), "{error}");
}

/// The cheapest first cut of boxes, each way to part them by their middles along an axis tried in f64.
fn cheapest_cut(boxes: &[Aabb]) -> f64 {
    let area = |boxes: &[Aabb]| {
        let size = boxes.iter().fold(Aabb::EMPTY, |all, one| all.union(*one)).size().as_dvec3();
        (size.x * size.y + size.y * size.z + size.z * size.x) * boxes.len() as f64
    };
    let mut best = f64::INFINITY;
    for axis in 0..3 {
        let mut sorted = boxes.to_vec();
        sorted.sort_by(|a, b| (a.min[axis] + a.max[axis]).total_cmp(&(b.min[axis] + b.max[axis])));
        for at in 1..sorted.len() {
            best = best.min(area(&sorted[..at]) + area(&sorted[at..]));
        }
    }
    best
}

/// What the first cut of a hierarchy costs, reckoned likewise.
fn first_cut(bvh: &BinaryBvh) -> f64 {
    let below = |child: usize| {
        let mut open = vec![child];
        let mut items = 0;
        while let Some(node) = open.pop().map(|node| bvh.nodes[node]) {
            items += node.count;
            if !node.is_leaf() {
                open.extend(node.children());
            }
        }
        let size = bvh.nodes[child].bounds.size().as_dvec3();
        (size.x * size.y + size.y * size.z + size.z * size.x) * f64::from(items)
    };
    bvh.nodes[0].children().map(below).iter().sum()
}

#[test]
fn the_heuristic_takes_the_cheapest_cut() {
    for seed in 1..20 {
        let boxes = boxes_of(&scattered(20 + 5 * seed as usize, seed));
        let mut bvh = BinaryBvh::default();
        let mut build = |name| {
            Builder::new(name, &Settings::default()).unwrap().build(&Input::of(&boxes), &mut bvh).unwrap();
            first_cut(&bvh)
        };
        let (sweep, binned, oracle) = (build("sweep_sah"), build("binned_sah"), cheapest_cut(&boxes));
        assert!((sweep / oracle - 1.0).abs() < 1e-5, "{seed}: {sweep} and not {oracle}");
        assert!(binned >= oracle * 0.99999 && binned < oracle * 1.2, "{seed}: {binned} against {oracle}");
    }
}

#[test]
fn every_vector_unit_builds_the_same() {
    let mut settings = Settings::default();
    for bins in [2, 5, 16, 64] {
        settings.bins = bins;
        for (what, boxes) in nasty().into_iter().chain([("many", boxes_of(&scattered(5000, 9)))]) {
            let built = [Unit::best(), Unit::Plain].map(|unit| {
                let mut rule = binned_sah::SahRule::new(&settings);
                rule.unit = unit;
                let mut bvh = BinaryBvh::default();
                yard::Yard::default().build(&rule, &boxes, &mut bvh).expect("they are fine");
                bvh
            });
            // As text, which tells -0 from 0.
            assert_eq!(format!("{:?}", built[0]), format!("{:?}", built[1]), "{what}, {bins} bins");
        }
    }
}

#[test]
fn better_builders_cost_rays_less() {
    let triangles = scattered(4000, 5);
    let boxes = boxes_of(&triangles);
    let cost = |name| {
        let mut bvh = BinaryBvh::default();
        let mut builder = Builder::new(name, &Settings::default()).unwrap();
        builder.build(&Input { boxes: &boxes, triangles: Some(&triangles) }, &mut bvh).unwrap();
        bvh.validate(&boxes).unwrap();
        bvh.cost(1.0, 1.0)
    };
    let (sweep, binned, median, morton) =
        (cost("sweep_sah"), cost("binned_sah"), cost("spatial_median"), cost("morton"));
    assert!(
        sweep < binned * 1.02 && binned < median && binned < morton,
        "{sweep} {binned} {median} {morton}"
    );
    assert!(morton < binned * 1.3, "{binned} {morton}");
    // Long thin triangles across all axes, which only cutting keeps apart.
    let mut next = noise(8);
    let mut point = |size: f32| Vec3::new(next(), next(), next()) * size;
    let corner = |_| {
        let at = point(1.0);
        [at, at + 5.0, at + point(0.1)]
    };
    let skinny: Vec<_> = (0..500).map(corner).collect();
    let boxes = boxes_of(&skinny);
    let settings = Settings { duplicates: 8.0, ..Settings::default() };
    let [sweep, spatial] = ["sweep_sah", "spatial_splits"].map(|name| {
        let mut bvh = BinaryBvh::default();
        let mut builder = Builder::new(name, &settings).unwrap();
        builder.build(&Input { boxes: &boxes, triangles: Some(&skinny) }, &mut bvh).unwrap();
        bvh.validate(&boxes).unwrap();
        assert!(bvh.order.len() <= 9 * 500, "references are bounded");
        bvh.cost(1.0, 1.0)
    });
    assert!(spatial < sweep * 0.9, "{sweep} {spatial}");
}

#[test]
fn refitting_what_did_not_move_changes_nothing() {
    let boxes = boxes_of(&scattered(1000, 2));
    each_builder(&Settings::default(), |name, builder| {
        let mut bvh = BinaryBvh::default();
        builder.build(&Input::of(&boxes), &mut bvh).unwrap();
        let built = bvh.clone();
        refit::refit(&mut bvh, &boxes);
        // What was cut in two is whole again.
        assert!(bvh == built || name == "spatial_splits", "{name}");
        let moved: Vec<Aabb> = boxes_of(&scattered(1000, 4));
        refit::refit(&mut bvh, &moved);
        bvh.validate(&moved).unwrap();
        assert!(bvh.cost(1.0, 1.0) > built.cost(1.0, 1.0), "{name}: shuffled items cost more");
    });
}

mod phases {
    use super::*;
    use crate::structure::bvh::build::phased::{Alone, Phased, Team, Way};

    /// A team that says it is of many, and does pieces back to front.
    struct Backwards(usize);

    impl Team for Backwards {
        type Error = BuildError;
        fn processors(&self) -> usize {
            self.0
        }
        fn each(&mut self, pieces: usize, work: impl Fn(usize) -> Effort + Sync) -> Result<(), BuildError> {
            (0..pieces).rev().for_each(|piece| {
                work(piece);
            });
            Ok(())
        }
    }

    #[test]
    fn the_hierarchy_is_the_same_whatever_the_team() {
        let settings = Settings::default();
        let many = [("many", boxes_of(&scattered(30_000, 11)))];
        for (name, way) in Way::ALL {
            let mut phased = Phased::new(way, &settings).unwrap();
            for (what, boxes) in nasty().into_iter().chain(many.clone()) {
                let input = Input::of(&boxes);
                let mut alone = BinaryBvh::default();
                phased.build(&input, &mut alone, &mut Alone).unwrap();
                alone.validate(&boxes).unwrap_or_else(|error| panic!("{name}, {what}: {error}"));
                assert!(alone.statistics().depth <= MOST_DEPTH);
                if way == Way::SahSah {
                    let mut serial = BinaryBvh::default();
                    Builder::new("binned_sah", &settings).unwrap().build(&input, &mut serial).unwrap();
                    assert_eq!(alone, serial, "{name}, {what}: in phases and not");
                }
                for processors in [2, 3, 64] {
                    let mut bvh = BinaryBvh::default();
                    phased.build(&input, &mut bvh, &mut Backwards(processors)).unwrap();
                    assert_eq!(bvh, alone, "{name}, {what}: {processors} processors");
                }
            }
            let mut bad = many[0].1.clone();
            bad[29_000] = Aabb::EMPTY;
            bad[700].min.x = f32::NAN;
            let error =
                phased.build(&Input::of(&bad), &mut BinaryBvh::default(), &mut Backwards(4)).unwrap_err();
            assert!(matches!(error, BuildError::NoBox { item: 700, .. }), "{error}");
        }
    }
}
