//! The test of a frame for whatever volumes a tree has.

use crate::geometry::culling::{Asymmetric, Culler, Memory, Motion, Steps, Verdict};
use crate::geometry::{Aabb, Frustum, KDop, Obb, Sphere};
use crate::machine::{Layout, Machine, Processor, Shared};
use crate::structure::Volumes;

/// Puts down, once for each kind of volume, the array of a tree and the test of a frame.
macro_rules! volumes {
    ($($kind:ident: $volume:ty),*) => {
        /// The volumes of a tree's nodes in shared memory, where they are not the nodes' own boxes.
        pub(super) enum NodeVolumes {
            Aabb,
            $($kind(Shared<$volume>),)*
        }

        impl NodeVolumes {
            /// Copies them there.
            pub(super) fn new<M: Machine>(machine: &M, volumes: &Volumes, nodes: usize) -> Self {
                match volumes {
                    Volumes::Aabb => Self::Aabb,
                    $(Volumes::$kind(volumes) => {
                        assert_eq!(volumes.len(), nodes, "expected one volume a node");
                        Self::$kind(machine.alloc(nodes, Layout::Packed, |i| volumes[i]))
                    })*
                }
            }

            /// Copies those of some nodes again. Nodes tested by their own boxes have none.
            pub(super) fn renew(&mut self, volumes: &Volumes, nodes: &[u32]) {
                match (self, volumes) {
                    (Self::Aabb, _) => {}
                    $((Self::$kind(kept), Volumes::$kind(volumes)) => {
                        nodes.iter().for_each(|&node| kept[node as usize] = volumes[node as usize]);
                    })*
                    _ => panic!("expected volumes of the kind that the tree was made with"),
                }
            }

            /// Notes that a processor reads a node's volume.
            #[inline]
            pub(super) fn touch<P: Processor>(&self, node: usize, cpu: &P) {
                match self {
                    Self::Aabb => {}
                    $(Self::$kind(volumes) => cpu.touch(&volumes[node]),)*
                }
            }
        }

        /// The test of a frame.
        pub(super) enum Test<'a> {
            Aabb(Culler<'a, Aabb>),
            $($kind(Culler<'a, $volume>, &'a Shared<$volume>),)*
        }

        impl<'a> Test<'a> {
            pub(super) fn new(
                volumes: &'a NodeVolumes,
                frustum: &'a Frustum,
                steps: Steps,
                motion: Option<Motion>,
            ) -> Result<Self, Asymmetric> {
                Ok(match volumes {
                    NodeVolumes::Aabb => Self::Aabb(Culler::new(frustum, steps, motion)?),
                    $(NodeVolumes::$kind(volumes) => {
                        Self::$kind(Culler::new(frustum, steps, motion)?, volumes)
                    })*
                })
            }

            /// Tests a node, whose own box is `bounds`.
            #[inline]
            pub(super) fn classify<K: Memory>(&self, node: usize, bounds: &Aabb, kept: &K, mask: u8) -> Verdict {
                match self {
                    Self::Aabb(culler) => culler.classify(bounds, kept, mask),
                    other => other.classify_other(node, kept, mask),
                }
            }

            /// The same for the other volumes: apart, so that not every scheme has the code of them all in it.
            #[inline(never)]
            fn classify_other<K: Memory>(&self, node: usize, kept: &K, mask: u8) -> Verdict {
                match self {
                    Self::Aabb(_) => unreachable!("boxes are tested where they are"),
                    $(Self::$kind(culler, volumes) => culler.classify(&volumes[node], kept, mask),)*
                }
            }
        }
    };
}

volumes!(Obb: Obb, Sphere: Sphere, Dop14: KDop<7>, Dop18: KDop<9>, Dop26: KDop<13>);
