//! Whom an idle processor turns to.

/// Up to so many processors everybody turns to everybody.
const ALL: usize = 16;

/// The processors that processor `me` of `count` takes work from: all others in turn, or where there are
/// many those at distances 1, 2, 4, ... on the ring, through which work reaches everybody in a
/// logarithmic number of steps while each idle processor watches a few words only.
pub(super) fn neighbours(me: usize, count: usize) -> impl Iterator<Item = usize> + Clone {
    let few = count <= ALL;
    let steps = if few { count.saturating_sub(1) } else { (count - 1).ilog2() as usize + 1 };
    (0..steps).map(move |i| (me + if few { i + 1 } else { 1 << i }) % count)
}

#[cfg(test)]
mod tests {
    use super::neighbours;

    #[test]
    fn everybody_can_be_reached_and_nobody_is_his_own_neighbour() {
        for count in (1..40).chain([64, 100, 1000, 1024, 4096]) {
            let mut reached = vec![false; count];
            let mut open = vec![0];
            while let Some(me) = open.pop() {
                if !std::mem::replace(&mut reached[me], true) {
                    assert!(neighbours(me, count).all(|other| other != me && other < count));
                    open.extend(neighbours(me, count));
                }
            }
            assert!(reached.iter().all(|&r| r), "P = {count}");
        }
    }
}
