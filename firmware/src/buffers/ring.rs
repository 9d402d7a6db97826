//! The line ring: line buffers, and the ends of frames between them, in the order of the wires.
//!
//! ```text
//!  Free ──claim──► Armed ──push──► Ready ──pop──► Leased ──release──► Free
//!                                    └ line 478 · line 479, end of frame 7 · line 0 · line 1
//! ```
//!
//! The end of a frame needs no buffer: it hangs on the line before it. If no line of a frame was kept, two ends meet
//! and the newer stays, so that memory is bounded whatever the consumer does.

use crate::driver::verdict::Verdict;

/// What is known of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineInfo {
    /// Sequence number of its frame; see [`Verdict::sequence`].
    pub frame: u32,
    /// Number of the line in its frame, from 0.
    pub index: u32,
    /// Bytes.
    pub bytes: u32,
}

/// State of one buffer.
#[derive(Clone, Copy, Debug, Default)]
enum State {
    #[default]
    Free,
    /// The DMA fills it, or is going to.
    Armed,
    /// `ahead` lines are ready that came before it.
    Ready {
        line: LineInfo,
        ahead: u8,
        end: Option<Verdict>,
    },
    Leased,
}

/// What comes next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// A line; its buffer is leased now.
    Line {
        /// The buffer.
        slot: usize,
        /// The line.
        line: LineInfo,
    },
    /// The end of a frame.
    End(Verdict),
}

/// The states of `N` line buffers, 2 of which the DMA holds. `N` is at most 255.
#[derive(Clone, Copy, Debug)]
pub struct LineRing<const N: usize> {
    states: [State; N],
    /// The end of a frame all of whose lines have left.
    end: Option<Verdict>,
    ready: u8,
}

impl<const N: usize> Default for LineRing<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> LineRing<N> {
    /// All buffers free.
    #[must_use]
    pub const fn new() -> Self {
        Self { states: [State::Free; N], end: None, ready: 0 }
    }

    /// Takes a free buffer to fill.
    pub fn claim(&mut self) -> Option<usize> {
        let slot = self.states.iter().position(|state| matches!(state, State::Free))?;
        self.set(slot, State::Armed);
        Some(slot)
    }

    /// The line in an armed buffer is complete. False, and nothing happens, if the buffer was not armed.
    pub fn push(&mut self, slot: usize, line: LineInfo) -> bool {
        let armed = matches!(self.states.get(slot), Some(State::Armed));
        if armed {
            self.set(slot, State::Ready { line, ahead: self.ready, end: None });
            self.ready += 1;
        }
        armed
    }

    /// The frame of the lines pushed so far has ended. Returns the end that this one displaces, if no line lay between.
    pub fn end_frame(&mut self, verdict: Verdict) -> Option<Verdict> {
        let newest = self.ready.wrapping_sub(1);
        for state in &mut self.states {
            if let State::Ready { ahead, end, .. } = state
                && *ahead == newest
            {
                return end.replace(verdict);
            }
        }
        self.end.replace(verdict)
    }

    /// Takes out what comes next.
    pub fn pop(&mut self) -> Option<Next> {
        if let Some(verdict) = self.end.take() {
            return Some(Next::End(verdict));
        }
        let mut next = None;
        for (slot, state) in self.states.iter_mut().enumerate() {
            if let State::Ready { line, ahead, end } = state {
                match ahead.checked_sub(1) {
                    Some(fewer) => *ahead = fewer,
                    None => {
                        next = Some(Next::Line { slot, line: *line });
                        self.end = *end;
                        *state = State::Leased;
                    }
                }
            }
        }
        self.ready = self.ready.saturating_sub(1);
        next
    }

    /// A leased buffer came back. False, and nothing happens, if it was not leased.
    pub fn release(&mut self, slot: usize) -> bool {
        let leased = matches!(self.states.get(slot), Some(State::Leased));
        if leased {
            self.set(slot, State::Free);
        }
        leased
    }

    /// Frees the armed buffers: the DMA has stopped.
    pub fn disarm(&mut self) {
        for state in &mut self.states {
            if matches!(state, State::Armed) {
                *state = State::Free;
            }
        }
    }

    /// Frees all buffers that are not leased, and forgets the ends of frames.
    pub fn clear(&mut self) {
        for state in &mut self.states {
            if !matches!(state, State::Leased) {
                *state = State::Free;
            }
        }
        (self.end, self.ready) = (None, 0);
    }

    /// Something can be popped.
    #[must_use]
    pub fn has_next(&self) -> bool {
        self.end.is_some() || self.ready > 0
    }

    /// Buffers that are free.
    #[must_use]
    pub fn free(&self) -> usize {
        self.states.iter().filter(|state| matches!(state, State::Free)).count()
    }

    fn set(&mut self, slot: usize, to: State) {
        if let Some(state) = self.states.get_mut(slot) {
            *state = to;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::VecDeque;

    proptest! {
        /// Any order of calls against a queue that grows as it likes.
        #[test]
        fn lines_and_ends_leave_in_the_order_they_came(calls in prop::collection::vec((0_u8..5, 0_usize..6), 1..200)) {
            let mut ring = LineRing::<5>::new();
            let mut queue: VecDeque<Next> = VecDeque::new();
            let (mut armed, mut leased, mut count) = (vec![], vec![], 0);
            for (call, slot) in calls {
                match call {
                    0 => armed.extend(ring.claim()),
                    1 => {
                        count += 1;
                        let line = LineInfo { frame: 0, index: count, bytes: 8 };
                        let known = armed.iter().position(|&one| one == slot);
                        prop_assert_eq!(ring.push(slot, line), known.is_some());
                        if let Some(index) = known {
                            armed.swap_remove(index);
                            queue.push_back(Next::Line { slot, line });
                        }
                    }
                    2 => {
                        count += 1;
                        let end = Verdict { sequence: count, ..Verdict::default() };
                        let displaced = match queue.back() {
                            Some(&Next::End(verdict)) => { queue.pop_back(); Some(verdict) }
                            _ => None,
                        };
                        queue.push_back(Next::End(end));
                        prop_assert_eq!(ring.end_frame(end), displaced);
                    }
                    3 => {
                        prop_assert_eq!(ring.has_next(), !queue.is_empty());
                        let next = ring.pop();
                        prop_assert_eq!(next, queue.pop_front());
                        if let Some(Next::Line { slot, .. }) = next {
                            leased.push(slot);
                        }
                    }
                    _ => {
                        let known = leased.iter().position(|&one| one == slot);
                        prop_assert_eq!(ring.release(slot), known.is_some());
                        known.map(|index| leased.swap_remove(index));
                    }
                }
                let lines = queue.iter().filter(|next| matches!(next, Next::Line { .. })).count();
                prop_assert_eq!(ring.free() + armed.len() + lines + leased.len(), 5);
            }
        }
    }

    #[test]
    fn disarming_keeps_what_is_ready() {
        let mut ring = LineRing::<3>::new();
        let (first, _) = (ring.claim().unwrap(), ring.claim().unwrap());
        ring.push(first, LineInfo::default());
        ring.disarm();
        assert_eq!((ring.free(), ring.has_next()), (2, true));
        ring.clear();
        assert_eq!((ring.free(), ring.has_next()), (3, false));
    }
}
