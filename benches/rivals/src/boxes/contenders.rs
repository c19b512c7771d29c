//! Who is timed: ours first, then the memory alone, then the others.

use apportion::geometry::{Aabb, BoxTest, Camera, Frustum, Kernel, culling};
use apportion::job::cull_boxes::{BoxField, Costs, Frame, Way};
use apportion::machine::{Machine, Threads};
use apportion::scheme::tiles::Scheme;
use apportion::structure::{BitMask, BoxTree, Boxes, cull_blocks, cull_into};
use bevy_camera::primitives as bevy;
use bevy_shape::ViewFrustum;
use glam::camera::rh::proj::{directx, opengl};
use glam::camera::rh::view::look_to_mat4;
use glam::{Mat4, Vec3};
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhNode};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::hint::black_box;
use std::rc::Rc;
use treeculler::BVol;

/// What all of them are given.
pub(crate) struct Setting<'a> {
    pub(crate) all: &'a [Aabb],
    pub(crate) flat: &'a Boxes,
    pub(crate) tree: &'a BoxTree,
    pub(crate) cameras: &'a [Camera],
}

/// One way to cull.
pub(crate) struct Contender<'a> {
    pub(crate) name: String,
    /// Culls for the camera of a frame.
    pub(crate) run: Box<dyn FnMut(usize) + 'a>,
    /// The boxes seen, by their place among those given; none of what only reads.
    pub(crate) seen: Option<Box<dyn FnMut(usize) -> Vec<u32> + 'a>>,
}

/// A contender that fills a mask in the order of the boxes.
fn masked<'a>(
    name: &str,
    cull: impl FnMut(usize, &mut BitMask) + 'a,
    order: Option<&'a [u32]>,
    len: usize,
) -> Contender<'a> {
    let state = Rc::new(RefCell::new((cull, BitMask::new(len))));
    let other = state.clone();
    let run = move |frame| {
        let (cull, mask) = &mut *state.borrow_mut();
        cull(frame, mask);
        black_box(mask.words());
    };
    let seen = move |frame| {
        let (cull, mask) = &mut *other.borrow_mut();
        cull(frame, mask);
        mask.ones().map(|i| order.map_or(i as u32, |order| order[i])).collect()
    };
    Contender { name: name.to_owned(), run: Box::new(run), seen: Some(Box::new(seen)) }
}

/// Sets the bit of each box for which `is_seen`.
fn each<T>(boxes: &[T], mask: &mut BitMask, is_seen: impl Fn(&T) -> bool) {
    for (word, boxes) in mask.words_mut().iter_mut().zip(boxes.chunks(64)) {
        *word = boxes.iter().enumerate().fold(0, |word, (bit, one)| word | u64::from(is_seen(one)) << bit);
    }
}

pub(crate) fn all<'a>(setting: &'a Setting<'a>) -> Vec<Contender<'a>> {
    let Setting { all, flat, tree, cameras } = *setting;
    let len = all.len();
    let mut contenders = vec![masked(
        &format!("flat, {:?}, one thread", Kernel::best()),
        |frame, mask| cull_into(flat, &Frustum::new(&cameras[frame]), mask),
        None,
        len,
    )];
    contenders.push(stream(flat));
    contenders.extend([Way::Flat, Way::Stream].map(|way| two_threads(setting, way)));
    contenders.push(masked(
        "box tree, one thread",
        |frame, mask| tree.cull_into(&Frustum::new(&cameras[frame]), mask),
        Some(tree.order()),
        len,
    ));
    for kernel in Kernel::all().filter(|kernel| *kernel != Kernel::best()) {
        let cull = move |frame: usize, mask: &mut BitMask| {
            let test = BoxTest::with_kernel(&Frustum::new(&cameras[frame]), kernel);
            cull_blocks(flat, &test, 0..flat.blocks().len(), mask.words_mut());
        };
        contenders.push(masked(&format!("flat, {kernel:?}"), cull, None, len));
    }
    let plain = |frame: usize, mask: &mut BitMask| {
        let frustum = Frustum::new(&cameras[frame]);
        each(all, mask, |bounds| !matches!(culling::basic(bounds, &frustum).side, culling::Side::Outside(_)));
    };
    contenders.push(masked("geometry::culling::basic, box by box", plain, None, len));
    contenders.push(bevy(setting));
    contenders.push(treeculler(setting));
    contenders.extend(
        [("binned", BvhBuildStrategy::Binned), ("ploc", BvhBuildStrategy::Ploc)]
            .map(|(name, strategy)| parry(setting, name, strategy)),
    );
    contenders
}

/// Reads the flat kernel's memory and does nothing with it.
fn stream(flat: &Boxes) -> Contender<'_> {
    let run = move |_frame| {
        let mut bits = [0_u32; 32];
        for column in flat.blocks().iter().flat_map(|block| block.columns()) {
            for part in column.as_chunks::<32>().0 {
                bits.iter_mut().zip(part).for_each(|(a, b)| *a ^= b.to_bits());
            }
        }
        black_box(bits);
    };
    Contender { name: "reading the same memory".to_owned(), run: Box::new(run), seen: None }
}

/// On two threads of a team that spins, half each.
fn two_threads<'a>(setting: &Setting<'a>, way: Way) -> Contender<'a> {
    let (team, cameras) = (Threads::new(2).expect("two threads"), setting.cameras);
    let mut scheme = Scheme::new("static_blocks", &team, 2, BTreeMap::new()).expect("it takes no settings");
    let field = BoxField::new(&team, setting.tree, false);
    let run = move |frame: usize| {
        let frustum = Frustum::new(&cameras[frame]);
        let frame = Frame::new(&field, way, &frustum, BoxTest::new(&frustum), Costs::default());
        scheme.run(&team, &frame).expect("no worker panics");
        black_box(team.now());
    };
    let what = if way == Way::Flat { "flat" } else { "reading" };
    Contender { name: format!("{what}, static_blocks, two threads"), run: Box::new(run), seen: None }
}

fn clip_from_world(camera: &Camera, projection: Mat4) -> Mat4 {
    let [eye, forward, up] = [camera.eye, camera.forward, camera.up].map(|v| Vec3::from_array(v.to_array()));
    projection * look_to_mat4(eye, forward, up)
}

/// Opening angle and width over height.
fn lens(camera: &Camera) -> (f32, f32) {
    match camera.lens {
        apportion::geometry::Lens::Symmetric { fov_y, aspect } => (fov_y, aspect),
        other => panic!("no such lens is made here: {other:?}"),
    }
}

fn bevy_frusta(cameras: &[Camera]) -> Vec<bevy::Frustum> {
    let one = |camera: &Camera| {
        let (fov_y, aspect) = lens(camera);
        // Near and far the other way round: bevy's depth goes from 1 to 0.
        let projection = directx::perspective(fov_y, aspect, camera.far, camera.near);
        bevy::Frustum(ViewFrustum::from_clip_from_world(&clip_from_world(camera, projection)))
    };
    cameras.iter().map(one).collect()
}

fn bevy<'a>(setting: &Setting<'a>) -> Contender<'a> {
    let vector = |v: &[f32; 3]| Vec3::from_array(*v);
    let one = |b: &Aabb| bevy::Aabb::from_min_max(vector(&b.min.to_array()), vector(&b.max.to_array()));
    let boxes: Vec<_> = setting.all.iter().map(one).collect();
    let frusta = bevy_frusta(setting.cameras);
    let cull = move |frame: usize, mask: &mut BitMask| {
        let frustum: &bevy::Frustum = &frusta[frame];
        each(&boxes, mask, |bounds| frustum.intersects_obb_identity(bounds));
    };
    masked("bevy_camera intersects_obb_identity", cull, None, setting.all.len())
}

fn treeculler<'a>(setting: &Setting<'a>) -> Contender<'a> {
    let one = |b: &Aabb| treeculler::AABB::<f32>::new(b.min.to_array(), b.max.to_array());
    let boxes: Vec<_> = setting.all.iter().map(one).collect();
    let frusta: Vec<_> = setting
        .cameras
        .iter()
        .map(|camera| {
            let (fov_y, aspect) = lens(camera);
            let projection = opengl::perspective(fov_y, aspect, camera.near, camera.far);
            treeculler::Frustum::from_modelview_projection(
                clip_from_world(camera, projection).to_cols_array_2d(),
            )
        })
        .collect();
    let cull = move |frame: usize, mask: &mut BitMask| {
        each(&boxes, mask, |bounds| bounds.test_against_frustum(&frusta[frame], 0) != u8::MAX);
    };
    masked("treeculler test_against_frustum", cull, None, setting.all.len())
}

/// Parry's tree, descended with bevy's test; it tells the leaves, so the mask is not asked for.
fn parry<'a>(setting: &Setting<'a>, name: &str, strategy: BvhBuildStrategy) -> Contender<'a> {
    let vector = |v: [f32; 3]| v.into();
    let leaves: Vec<_> = setting
        .all
        .iter()
        .map(|b| parry3d::bounding_volume::Aabb::new(vector(b.min.to_array()), vector(b.max.to_array())))
        .collect();
    let tree = Rc::new(Bvh::from_leaves(strategy, &leaves));
    let frusta = Rc::new(bevy_frusta(setting.cameras));
    let walk = move |frame: usize, found: &mut Vec<u32>| {
        let frustum = &frusta[frame];
        let is_seen = |node: &BvhNode| {
            let [min, max] = [node.mins(), node.maxs()].map(|v| Vec3::new(v.x, v.y, v.z));
            frustum.intersects_obb_identity(&bevy::Aabb::from_min_max(min, max))
        };
        found.clear();
        found.extend(tree.leaves(is_seen));
    };
    let again = walk.clone();
    let mut found = Vec::new();
    let run = move |frame| {
        walk(frame, &mut found);
        black_box(&found);
    };
    let seen = move |frame| {
        let mut found = Vec::new();
        again(frame, &mut found);
        found
    };
    let name = format!("parry3d Bvh ({name}) leaves, bevy's test");
    Contender { name, run: Box::new(run), seen: Some(Box::new(seen)) }
}
