//! Boxes, spheres, frusta, planes: pure functions, f32 kernels with f64 oracles beside them.
