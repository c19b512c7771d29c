//! Places on a Z-order curve through space (Morton 1966), and items sorted by them.

use super::bins::Grating;
use super::lanes::{Box8, Lanes, Unit, on_unit};
use super::yard::{View, make_room};
use crate::geometry::Aabb;

/// Bits of a place on each axis: as many as three numbers of 32 bits together have room for.
const AXIS_BITS: u32 = 10;
/// Bits of an item's number, below those of its place.
const ITEM_BITS: u32 = 64 - 3 * AXIS_BITS;
const DIGITS: usize = 1 << AXIS_BITS;
/// How many items have each value of each digit of their places, the lowest digit first.
type Counts = [[u32; DIGITS]; 3];

/// The item of a code.
pub(super) fn item(code: u64) -> usize {
    (code & ((1 << ITEM_BITS) - 1)) as usize
}

/// Writes the codes of items, place above and number below, sorted to the first of two places. Items in one place
/// come by their number.
pub(super) fn sort(unit: Unit, boxes: &[Aabb], view: &View, middles: &Box8, codes: &mut [Vec<u64>; 2]) {
    let [codes, room] = codes;
    let mut counts: Counts = [[0; DIGITS]; 3];
    make_room(codes, boxes.len(), 0);
    make_room(room, boxes.len(), 0);
    encode(unit, boxes, view, &Grating::new(middles, DIGITS), codes, &mut counts);
    // Three passes of a radix sort, the lowest digit first; each keeps the order of the one before.
    for (digit, counts) in counts.iter_mut().enumerate() {
        let mut sum = 0;
        for count in &mut *counts {
            (*count, sum) = (sum, sum + *count);
        }
        for code in &**codes {
            let place = &mut counts[(code >> (ITEM_BITS + digit as u32 * AXIS_BITS)) as usize % DIGITS];
            room[*place as usize] = *code;
            *place += 1;
        }
        std::mem::swap(codes, room);
    }
}

on_unit! {
    /// Writes the codes of items, and counts their digits.
    fn encode(boxes: &[Aabb], view: &View, grating: &Grating, codes: &mut [u64], counts: &mut Counts) -> () =
        encode_with
}

/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn encode_with<L: Lanes>(
    boxes: &[Aabb],
    view: &View,
    grating: &Grating,
    codes: &mut [u64],
    counts: &mut Counts,
) {
    // SAFETY: the unit is there; middles lie between the outermost ones, which makes bins of at most `DIGITS`.
    unsafe {
        let (from, scale, last) = grating.lanes::<L>();
        for (number, (bounds, code)) in boxes.iter().zip(codes).enumerate() {
            let bounds = view.load::<L>(bounds);
            let [x, y, z, _] = spread(L::bins(bounds.middle(), from, scale, last).map(|bin| bin as u32));
            let place = x << 2 | y << 1 | z;
            for (digit, counts) in counts.iter_mut().enumerate() {
                counts[(place >> (digit as u32 * AXIS_BITS)) as usize % DIGITS] += 1;
            }
            *code = u64::from(place) << ITEM_BITS | number as u64;
        }
    }
}

/// Two zeros above each of the lowest ten bits.
#[inline(always)]
fn spread(bits: [u32; 4]) -> [u32; 4] {
    let mut wide = bits;
    for (by, mask) in [(16, 0x0300_00ff), (8, 0x0300_f00f), (4, 0x030c_30c3), (2, 0x0924_9249)] {
        wide = wide.map(|bits| (bits | bits << by) & mask);
    }
    wide
}

/// Cuts sorted codes into runs of at most so many; writes where each begins, and the end of the last.
pub(super) fn clusters(codes: &[u64], most: usize, starts: &mut Vec<u32>) {
    let mut open = vec![(0, codes.len())];
    while let Some((start, end)) = open.pop() {
        if end - start <= most {
            starts.push(start as u32);
            continue;
        }
        // Items in one place are told apart by their numbers, so that codes differ always.
        let (first, last) = (codes[start], codes[end - 1]);
        let highest = 63 - (first ^ last).leading_zeros();
        let ahead = codes[start..end].partition_point(|code| code >> highest & 1 == 0);
        let middle = start + ahead;
        open.push((middle, end));
        open.push((start, middle));
    }
    starts.push(codes.len() as u32);
}
