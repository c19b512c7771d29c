//! Places on a Z-order curve through space (Morton 1966), and items sorted by them.

use super::bins::Grating;
use super::lanes::Box8;
use super::yard::View;
use crate::geometry::Aabb;

/// Bits of a place on each axis.
const AXIS_BITS: u32 = 11;
/// Bits of an item's number, below those of its place.
const ITEM_BITS: u32 = 64 - 3 * AXIS_BITS;
const DIGITS: usize = 1 << AXIS_BITS;

/// The item of a code.
pub(super) fn item(code: u64) -> usize {
    (code & ((1 << ITEM_BITS) - 1)) as usize
}

/// Writes the codes of items, place above and number below, sorted to the first of two places. Items in one place
/// come by their number.
pub(super) fn sort(boxes: &[Aabb], view: &View, middles: &Box8, codes: &mut [Vec<u64>; 2]) {
    let grating = Grating::new(middles, DIGITS);
    let [codes, room] = codes;
    codes.clear();
    let mut counts = vec![[0_u32; DIGITS]; 3];
    codes.extend(boxes.iter().enumerate().map(|(number, bounds)| {
        let middles = view.bring(bounds).middles();
        let along = |axis: usize| spread(grating.bin_of(middles[axis], axis));
        let place = along(0) << 2 | along(1) << 1 | along(2);
        for (digit, counts) in counts.iter_mut().enumerate() {
            counts[(place >> (digit as u32 * AXIS_BITS)) as usize % DIGITS] += 1;
        }
        place << ITEM_BITS | number as u64
    }));
    room.resize(codes.len(), 0);
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

/// Two zeros above each of the lowest 16 bits.
fn spread(bits: u32) -> u64 {
    let mut wide = u64::from(bits);
    wide = (wide | wide << 16) & 0x001f_0000_ff00_00ff;
    wide = (wide | wide << 8) & 0x100f_00f0_0f00_f00f;
    wide = (wide | wide << 4) & 0x10c3_0c30_c30c_30c3;
    (wide | wide << 2) & 0x1249_2492_4924_9249
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
