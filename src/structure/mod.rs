//! What is built over a scene.
