//! How much of the processors' time the sharing itself takes (what Paper II splits into work and traversal).

use super::balance::share_figure;
use super::{Figure, Material};

pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    let says = "Time that went into sharing";
    let how =
        "Share of the processors' time that went into finding and handing over work, not into the work.";
    share_figure(
        material,
        "traversal_share",
        ("sharing", "What sharing costs"),
        ("time in sharing", says),
        how,
    )
}
