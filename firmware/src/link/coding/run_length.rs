//! Runs of equal units.
//!
//! ```text
//! c < 128    c + 1 units as they are
//! c ≥ 128    one unit, c − 126 times (2 to 129)
//! ```
//!
//! Cost: each unit is looked at twice. At worst one byte for each 128 units is added.

use super::room::Room;

const LITERALS: usize = 128;
const RUN: usize = 129;

/// Units of `N` bytes; bytes past the last whole one are refused.
pub(super) fn encode<const N: usize>(pixels: &[u8], room: &mut Room<'_>) -> Option<()> {
    let (units, rest) = pixels.as_chunks::<N>();
    rest.is_empty().then_some(())?;
    encode_units(units.len(), |at| units.get(at), room)
}

/// The units `unit(0)` to `unit(count - 1)`.
pub(super) fn encode_units<U: AsRef<[u8]> + PartialEq>(
    count: usize,
    unit: impl Fn(usize) -> Option<U>,
    room: &mut Room<'_>,
) -> Option<()> {
    let (mut literals, mut at) = (0, 0);
    while at < count {
        let here = unit(at)?;
        let mut run = 1;
        while run < RUN && at + run < count && unit(at + run)? == here {
            run += 1;
        }
        // Two equal bytes among literals are no shorter as a run.
        let worth = if literals > 0 && here.as_ref().len() == 1 { 3 } else { 2 };
        if run >= worth {
            put_literals(at - literals, literals, &unit, room)?;
            room.byte((run + 126) as u8)?;
            room.put(here.as_ref())?;
            (literals, at) = (0, at + run);
        } else {
            at += 1;
            literals += 1;
            if literals == LITERALS {
                put_literals(at - literals, literals, &unit, room)?;
                literals = 0;
            }
        }
    }
    put_literals(at - literals, literals, &unit, room)
}

fn put_literals<U: AsRef<[u8]>>(
    first: usize,
    count: usize,
    unit: &impl Fn(usize) -> Option<U>,
    room: &mut Room<'_>,
) -> Option<()> {
    if count > 0 {
        room.byte((count - 1) as u8)?;
        for at in first..first + count {
            room.put(unit(at)?.as_ref())?;
        }
    }
    Some(())
}

/// Units of `N` bytes.
pub(super) fn decode<const N: usize>(mut coded: &[u8], room: &mut Room<'_>) -> Option<()> {
    while let Some((&control, rest)) = coded.split_first() {
        let control = usize::from(control);
        if control < LITERALS {
            let (literals, rest) = rest.split_at_checked((control + 1) * N)?;
            room.put(literals)?;
            coded = rest;
        } else {
            let (unit, rest) = rest.split_first_chunk::<N>()?;
            let (units, _) = room.take((control - 126) * N)?.as_chunks_mut::<N>();
            units.fill(*unit);
            coded = rest;
        }
    }
    Some(())
}
