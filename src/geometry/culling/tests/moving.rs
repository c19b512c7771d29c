//! Translation and rotation coherency over paths, frame by frame against the oracle (P1-11, P1-12, P1-F05 to
//! P1-F08).

use super::strategies::{bounds, camera, near_the_eye};
use super::*;
use glam::Mat3;

/// What the camera does from one frame to the next.
#[derive(Clone, Copy, Debug)]
enum Move {
    Stand,
    /// By shares of the far distance along right, up, forward.
    Shift(Vec3),
    /// About the camera's right, up or forward axis, by an angle; the other two axes are made anew.
    Turn(usize, f32),
    /// Both.
    Both(Vec3, f32),
    /// Another field of view.
    Zoom(f32),
    /// Another depth range.
    Depth(f32),
}

fn turn(camera: &Camera, axis: usize, angle: f32) -> Camera {
    let axes = [camera.right, camera.up, camera.forward];
    let about = Mat3::from_axis_angle(axes[axis].normalize(), angle);
    // The axis itself stays as it is, bit for bit, as a careful program would leave it.
    let [right, up, forward] =
        [0, 1, 2].map(|i| if i == axis { axes[i] } else { (about * axes[i]).normalize() });
    Camera { right, up, forward, ..*camera }
}

impl Move {
    fn of(self, camera: &Camera) -> Camera {
        let shifted = |by: Vec3| {
            let way = camera.right * by.x + camera.up * by.y + camera.forward * by.z;
            Camera { eye: camera.eye + way * camera.far, ..*camera }
        };
        match self {
            Move::Stand => *camera,
            Move::Shift(by) => shifted(by),
            Move::Turn(axis, angle) => turn(camera, axis, angle),
            Move::Both(by, angle) => turn(&shifted(by), 1, angle),
            Move::Zoom(fov_y) => Camera { lens: Lens::Symmetric { fov_y, aspect: 1.2 }, ..*camera },
            Move::Depth(share) => Camera { far: camera.near + (camera.far - camera.near) * share, ..*camera },
        }
    }
}

fn a_move() -> impl Strategy<Value = Move> {
    let by = (-0.4f32..0.4, -0.4f32..0.4, -0.4f32..0.4).prop_map(|(x, y, z)| Vec3::new(x, y, z));
    prop_oneof![
        1 => Just(Move::Stand),
        4 => by.clone().prop_map(Move::Shift),
        6 => (0_usize..3, prop_oneof![0.01f32..0.6, -0.6f32..-0.01]).prop_map(|(axis, angle)| Move::Turn(axis, angle)),
        1 => (by, -0.4f32..0.4).prop_map(|(by, angle)| Move::Both(by, angle)),
        1 => (0.1f32..2.0).prop_map(Move::Zoom),
        1 => (0.3f32..1.0).prop_map(Move::Depth),
    ]
}

/// Runs of one kind of move, as when somebody turns around, and any moves at all.
fn moves() -> impl Strategy<Value = Vec<Move>> {
    let run = (a_move(), 1_usize..12).prop_map(|(step, times)| vec![step; times]);
    prop::collection::vec(run, 1..5).prop_map(|runs| runs.concat())
}

const COMBINATIONS: [&str; 8] = [
    "tr",
    "rotation+fields",
    "translation",
    "plane+tr+fields",
    "crossed+tr",
    "plane+octant+tr+fields",
    "plane+octant+tr+pair",
    "tr+mask+pair+fields",
];

/// How many verdicts were carried over.
fn follow<V: Exact>(start: &Camera, moves: &[Move], volume: &V) -> Result<u32, TestCaseError> {
    let mut carried = 0;
    for words in COMBINATIONS {
        let steps = steps(words);
        let (mut camera, mut motion) = (*start, None::<Motion>);
        let memory = Remembering::default();
        for (number, step) in [Move::Stand].iter().chain(moves).enumerate() {
            camera = step.of(&camera);
            let (frustum, oracle) = (Frustum::new(&camera), Hexahedron::new(&camera));
            let now = motion.map_or_else(|| Motion::start(&frustum), |motion| motion.next(&frustum));
            motion = Some(now);
            let Ok(culler) = Culler::new(&frustum, steps, Some(now)) else { break };
            let verdict = culler.classify(volume, &memory, 0);
            match verdict.side {
                Side::Outside(_) => {
                    prop_assert!(
                        !oracle.intersects(volume),
                        "{words}, frame {number}: culled a visible volume"
                    );
                }
                Side::Inside => {
                    prop_assert!(oracle.contains(volume), "{words}, frame {number}: says inside");
                }
                Side::Intersecting => {}
            }
            carried += u32::from(verdict.tests == 0);
        }
    }
    Ok(carried)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn nothing_visible_is_culled_on_any_path(
        (camera, bounds) in camera().prop_flat_map(|camera| {
            let boxes = prop_oneof![bounds(&camera), near_the_eye(&camera)];
            (Just(camera), boxes)
        }),
        moves in moves(),
    ) {
        follow(&camera, &moves, &bounds)?;
        follow(&camera, &moves, &Sphere::of_points(&bounds.corners()))?;
        follow(&camera, &moves, &Obb::from(bounds))?;
    }
}

fn ahead() -> Camera {
    let lens = Lens::Symmetric { fov_y: 1.0, aspect: 1.2 };
    Camera::look_at(Vec3::new(3.0, 1.0, -2.0), Vec3::new(3.0, 1.0, -9.0), Vec3::Y, lens, 0.1, 50.0).unwrap()
}

fn cube(centre: Vec3, half: f32) -> Aabb {
    Aabb { min: centre - half, max: centre + half }
}

/// The verdicts of one box along a path.
fn along(words: &str, start: &Camera, moves: &[Move], bounds: &Aabb) -> Vec<Verdict> {
    let (mut camera, mut motion) = (*start, None::<Motion>);
    let memory = Remembering::default();
    let frames = [Move::Stand].into_iter().chain(moves.iter().copied());
    let verdict = |step: Move| {
        camera = step.of(&camera);
        let frustum = Frustum::new(&camera);
        let now = motion.map_or_else(|| Motion::start(&frustum), |motion| motion.next(&frustum));
        motion = Some(now);
        Culler::new(&frustum, steps(words), Some(now)).unwrap().classify(bounds, &memory, 0)
    };
    frames.map(verdict).collect()
}

#[test]
fn a_turn_away_needs_no_test_and_ends_before_the_other_side_comes_round() {
    let camera = ahead();
    let left = cube(camera.eye + Vec3::new(-9.0, 0.0, -2.0), 0.5);
    // To the right, by 4 degrees a frame, once round and more.
    let verdicts = along("rotation", &camera, &[Move::Turn(1, -0.07); 110], &left);
    let tested: Vec<usize> = (0..verdicts.len()).filter(|&i| verdicts[i].tests > 0).collect();
    assert_eq!(verdicts[0].side, Side::Outside(0));
    let again = tested[1];
    let opening = 2.0 * (0.5f64.tan() * 1.2).atan();
    let limit = (std::f64::consts::PI - opening) / 0.07;
    assert!((again as f64 - limit).abs() < 2.0, "tested again in frame {again}, the limit is {limit}");
    assert!(verdicts.iter().any(|verdict| verdict.side != Side::Outside(0)), "it came into view");
    // The other way it comes into view at once: the plane does not trail.
    let other = along("rotation", &camera, &[Move::Turn(1, 0.07); 5], &left);
    assert!(other.iter().all(|verdict| verdict.tests > 0));
    // Up and down likewise, and a roll leaves near and far where they are.
    let below = cube(camera.eye + Vec3::new(0.0, -9.0, -2.0), 0.5);
    let up = along("rotation", &camera, &[Move::Turn(0, 0.05); 5], &below);
    assert!(up[1..].iter().all(|verdict| verdict.tests == 0), "{up:?}");
    let behind = cube(camera.eye + Vec3::new(0.0, 0.0, 6.0), 7.0 / 8.0);
    let roll = along("plane+rotation", &camera, &[Move::Turn(2, 0.5); 20], &behind);
    assert!(
        roll[1..].iter().all(|verdict| verdict.tests == 0 || verdict.side != Side::Outside(2)),
        "{roll:?}"
    );
}

#[test]
fn a_shift_carries_all_distances_over() {
    let camera = ahead();
    let bounds = cube(camera.eye + camera.forward * 10.0, 1.0);
    let verdicts = along("translation", &camera, &[Move::Shift(Vec3::new(0.01, 0.0, 0.002)); 60], &bounds);
    // The first frame cannot know that there will be an epoch.
    assert!(verdicts[..2].iter().all(|verdict| (verdict.side, verdict.tests) == (Side::Inside, 6)));
    assert!(verdicts[2..].iter().all(|verdict| verdict.tests == 0), "{verdicts:?}");
    assert_eq!(verdicts[60].side, Side::Outside(0), "it went out on the left");
}

/// P1-F07: what an early exit left out has no distance, and is tested when it is asked for.
#[test]
fn planes_that_were_left_out_are_tested_when_needed() {
    let camera = ahead();
    let bounds = cube(camera.eye + Vec3::new(-9.0, 0.0, -10.0), 1.0);
    let verdicts = along("translation", &camera, &[Move::Shift(Vec3::new(-0.01, 0.0, 0.0)); 16], &bounds);
    assert_eq!((verdicts[1].side, verdicts[1].tests), (Side::Outside(0), 1));
    let came_in = verdicts.iter().position(|verdict| verdict.side != Side::Outside(0)).unwrap();
    assert_eq!(verdicts[came_in].tests, 5, "the other five");
    assert!(verdicts[2..came_in].iter().all(|verdict| verdict.tests == 0));
}

/// P1-F07: added up frame by frame, distances drift; here they do not, however long the way.
#[test]
fn a_long_way_there_and_back_ends_in_no_doubt() {
    let camera = ahead();
    let bounds = cube(camera.eye + camera.forward * 10.0, 0.001);
    let to_and_fro = [Move::Shift(Vec3::new(0.003, 0.001, 0.0)), Move::Shift(Vec3::new(-0.003, -0.001, 0.0))];
    let verdicts = along("translation", &camera, &to_and_fro.repeat(20_000), &bounds);
    assert!(verdicts.iter().all(|verdict| verdict.side == Side::Inside));
    assert!(verdicts.iter().filter(|verdict| verdict.tests > 0).count() < 10, "epochs are few");
}

/// P1-F05: with a turn and a shift in each frame nothing is carried over, and P1-F06: nor after a zoom.
#[test]
fn nothing_is_carried_over_where_it_does_not_hold() {
    let camera = ahead();
    let left = cube(camera.eye + Vec3::new(-9.0, 0.0, -2.0), 0.5);
    for step in [Move::Both(Vec3::new(0.01, 0.0, 0.0), -0.05), Move::Zoom(0.9), Move::Depth(0.9)] {
        let verdicts = along("tr", &camera, &[step], &left);
        assert!(verdicts[1].tests > 0, "{step:?}");
    }
    let far = along("tr", &camera, &[Move::Shift(Vec3::new(1.5, 0.0, 0.0))], &left);
    assert!(far[1].tests > 0, "further than the far plane: tested exactly again");
}
