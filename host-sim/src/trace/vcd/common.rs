//! The common changes: nearly all of a file, and the loop that decides how fast it is read.
//!
//! ```text
//! rest  │ 1 ! \n 0 % \n # 1 8 0 8 4 \n …          a window of 32 bytes at the token, all of them in memory
//!         ▲ first character: 0 or 1 ─► identifier ─► bits of the state
//!                            #      ─► time, and a sample if the clock had its edge
//!                            b      ─► vector
//!                            blank  ─► on
//!                            else, or not as usual ─► back to the caller, with nothing done
//! ```
//!
//! Per scalar: one load of eight bytes, one entry of a table that the identifier's characters index, one update of the
//! state. No branch depends on a value. The window is the only bound check of a token.
//!
//! What counts is that where the next token begins does not wait for this one's bytes. So each length of an identifier has
//! its own branch, which the processor predicts, and the length of a time stamp is guessed ([`Guess`]). If the wires'
//! identifiers are of several lengths, there is nothing to predict: their ends are then computed, which takes as long every time
//! but less than a wrong prediction. Left is one wrong prediction per clock, if nobody can tell how many wires change.

use super::super::edges::EdgeSink;
use super::changes::Machine;
use super::ids::{IdTable, VECTOR};
use super::scan::{Window, binary, bit_count, blanks, is_blank, load, word};
use super::stamp::Guess;

impl Machine {
    /// Takes changes from `at` on, as long as they are common ones and begin before `limit`, behind which `bytes` goes on for at
    /// least a window. Gives back where the first other token, or blank, begins.
    pub(super) fn common<S: EdgeSink>(
        &mut self,
        bytes: &[u8],
        at: usize,
        limit: usize,
        ids: &IdTable,
        sink: &mut S,
    ) -> (usize, Result<(), S::Error>) {
        if ids.has_mixed_lengths() {
            self.take::<S, true>(bytes, at, limit, ids, sink)
        } else {
            self.take::<S, false>(bytes, at, limit, ids, sink)
        }
    }

    /// The loop, for identifiers of mixed lengths or of one.
    #[inline(never)]
    fn take<S: EdgeSink, const MIXED: bool>(
        &mut self,
        bytes: &[u8],
        at: usize,
        limit: usize,
        ids: &IdTable,
        sink: &mut S,
    ) -> (usize, Result<(), S::Error>) {
        // The last token may begin just before the limit.
        let body = bytes.get(..limit + size_of::<Window>() - 1).unwrap_or_default();
        let Some(mut rest) = body.get(at..) else { return (at, Ok(())) };
        // A copy, for the registers.
        let mut now = *self;
        let mut result = Ok(());
        while let Some(window) = rest.first_chunk() {
            let word = word(window, 0);
            let first = word as u8;
            if first & 0xFE == b'0' {
                let value = (u64::from(first) & 1).wrapping_neg();
                if !MIXED && is_blank((word >> 16) as u8) {
                    let Some(mask) = ids.short((word >> 8) as u8 as u16) else { break };
                    now.set(mask, value);
                    rest = &rest[3..];
                } else if !MIXED && is_blank((word >> 24) as u8) {
                    let Some(mask) = ids.short((word >> 8) as u16) else { break };
                    now.set(mask, value);
                    rest = &rest[4..];
                } else {
                    let ends = (blanks(word) & !0xFF).trailing_zeros() / 8;
                    // Without an end in sight the key is 0, which nothing has.
                    let kept = 1_u64.checked_shl(8 * ends).map_or(0, |bit| bit - 1);
                    let key = (word & kept) >> 8;
                    let entry = ids.first(key);
                    if entry.key != key {
                        break;
                    }
                    now.set(entry.mask, value);
                    rest = &rest[ends as usize % 8 + 1..];
                }
            } else if first == b'#' {
                let (time, length) = match now.guess.try_read(window) {
                    Some(read) => read,
                    None => {
                        let Some((time, length, guess)) = Guess::read(window) else { break };
                        now.guess = guess;
                        (time, length)
                    }
                };
                // The same time again is rare, and an earlier one an error.
                if time <= now.time {
                    break;
                }
                if let Err(error) = now.close(sink) {
                    result = Err(error);
                    break;
                }
                now.time = time;
                rest = &rest[length % size_of::<Window>()..];
            } else if first | 0x20 == b'b' {
                let Some((bits, mask, length)) = short_vector(window, ids) else { break };
                now.state = now.state & !mask | bits;
                rest = &rest[length % size_of::<Window>()..];
            } else if is_blank(first) {
                rest = &rest[1..];
            } else {
                break;
            }
        }
        *self = now;
        (body.len() - rest.len(), result)
    }

    /// Sets the wires of `mask` to `value`, which is all ones or none.
    #[inline(always)]
    fn set(&mut self, mask: u64, value: u64) {
        self.state ^= (self.state ^ value) & mask;
    }
}

/// A vector of up to 16 known bits with an identifier of up to six characters: the bits of the state, their mask, and the
/// bytes that it takes.
#[inline(always)]
fn short_vector(window: &Window, ids: &IdTable) -> Option<(u64, u64, usize)> {
    let digits = word(window, 1);
    let mut count = bit_count(digits);
    if count == 0 {
        return None;
    }
    let mut value = binary(digits, count);
    if count == 8 {
        let digits = word(window, 9);
        let more = bit_count(digits);
        if more > 0 {
            value = value << more | binary(digits, more);
            count += more;
        }
    }
    let count = count as usize;
    let behind = load(window, 1 + count);
    let ends = (blanks(behind) & !0xFF).trailing_zeros() / 8;
    if !is_blank(behind as u8) || !(2..8).contains(&ends) {
        return None;
    }
    let key = (behind & ((1 << (8 * ends)) - 1)) >> 8 | VECTOR;
    let entry = ids.first(key);
    if entry.key != key || count > entry.width() as usize {
        return None;
    }
    let length = 1 + count + ends as usize + 1;
    Some(ids.vector(entry).map_or((0, 0, length), |vector| (vector.bits(value), vector.mask, length)))
}
