//! The frame pool: which frame buffer is where.
//!
//! ```text
//!         claim            finish            lease
//!  Free ───────► Filling ─────────► Ready ─────────► Leased
//!   ▲               │                 │                 │
//!   └── abandon ────┴──── recycle ────┴──── release ────┘
//! ```
//!
//! A ready frame is known by its sequence number; more than 2³¹ frames must not lie between two that are ready.

use crate::driver::verdict::Verdict;

/// State of one buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    #[default]
    Free,
    Filling,
    Ready(Verdict),
    Leased,
}

/// Which ready frame a lease takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The newest; older ones are recycled.
    Newest,
    /// The oldest.
    Oldest,
}

/// A frame buffer that was leased.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lease {
    /// The buffer.
    pub slot: usize,
    /// The frame in it.
    pub verdict: Verdict,
    /// Older frames that were recycled.
    pub recycled: u32,
}

/// The states of `N` frame buffers.
#[derive(Clone, Copy, Debug)]
pub struct FramePool<const N: usize> {
    states: [State; N],
}

impl<const N: usize> Default for FramePool<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> FramePool<N> {
    /// All buffers free.
    #[must_use]
    pub const fn new() -> Self {
        Self { states: [State::Free; N] }
    }

    /// Takes a free buffer to fill.
    pub fn claim(&mut self) -> Option<usize> {
        let slot = self.states.iter().position(|state| *state == State::Free)?;
        self.set(slot, State::Filling);
        Some(slot)
    }

    /// Takes the oldest ready frame's buffer to fill; the frame is gone.
    pub fn recycle(&mut self) -> Option<usize> {
        let (slot, _) = self.ready(Order::Oldest)?;
        self.set(slot, State::Filling);
        Some(slot)
    }

    /// The frame in a buffer that was filling is complete. False, and nothing happens, if it was not filling.
    pub fn finish(&mut self, slot: usize, verdict: Verdict) -> bool {
        self.step(slot, |state| state == State::Filling, State::Ready(verdict))
    }

    /// What was filled in is of no use. False, and nothing happens, if the buffer was not filling.
    pub fn abandon(&mut self, slot: usize) -> bool {
        self.step(slot, |state| state == State::Filling, State::Free)
    }

    /// Takes a ready frame out.
    pub fn lease(&mut self, order: Order) -> Option<Lease> {
        let (slot, verdict) = self.ready(order)?;
        self.set(slot, State::Leased);
        let mut recycled = 0;
        for state in self.states.iter_mut().filter(|_| order == Order::Newest) {
            if matches!(state, State::Ready(_)) {
                *state = State::Free;
                recycled += 1;
            }
        }
        Some(Lease { slot, verdict, recycled })
    }

    /// A leased buffer came back. False, and nothing happens, if it was not leased.
    pub fn release(&mut self, slot: usize) -> bool {
        self.step(slot, |state| state == State::Leased, State::Free)
    }

    /// A frame is ready.
    #[must_use]
    pub fn has_ready(&self) -> bool {
        self.states.iter().any(|state| matches!(state, State::Ready(_)))
    }

    /// Buffers that are free.
    #[must_use]
    pub fn free(&self) -> usize {
        self.states.iter().filter(|state| **state == State::Free).count()
    }

    /// Frees all buffers that are not leased; returns how many frames were ready.
    pub fn clear(&mut self) -> u32 {
        let mut ready = 0;
        for state in self.states.iter_mut().filter(|state| **state != State::Leased) {
            ready += u32::from(matches!(state, State::Ready(_)));
            *state = State::Free;
        }
        ready
    }

    fn ready(&self, order: Order) -> Option<(usize, Verdict)> {
        let mut best: Option<(usize, Verdict)> = None;
        for (slot, state) in self.states.iter().enumerate() {
            if let State::Ready(verdict) = *state {
                let newer =
                    best.is_some_and(|(_, best)| verdict.sequence.wrapping_sub(best.sequence) < 1 << 31);
                if best.is_none() || newer == (order == Order::Newest) {
                    best = Some((slot, verdict));
                }
            }
        }
        best
    }

    fn step(&mut self, slot: usize, from: impl Fn(State) -> bool, to: State) -> bool {
        let fits = self.states.get(slot).is_some_and(|&state| from(state));
        if fits {
            self.set(slot, to);
        }
        fits
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

    fn frame(sequence: u32) -> Verdict {
        Verdict { sequence, ..Verdict::default() }
    }

    #[test]
    fn the_newest_is_leased_and_older_ones_go() {
        let mut pool = FramePool::<3>::new();
        // Across the wrap of the sequence.
        for sequence in [u32::MAX, 0, 1] {
            let slot = pool.claim().unwrap();
            assert!(pool.finish(slot, frame(sequence)));
        }
        assert_eq!(pool.claim(), None);
        let lease = pool.lease(Order::Newest).unwrap();
        assert_eq!((lease.verdict.sequence, lease.recycled, pool.free()), (1, 2, 2));
    }

    #[test]
    fn the_oldest_is_leased_or_recycled_first() {
        let mut pool = FramePool::<3>::new();
        for sequence in [u32::MAX, 0, 1] {
            let slot = pool.claim().unwrap();
            pool.finish(slot, frame(sequence));
        }
        assert_eq!(pool.lease(Order::Oldest).unwrap().verdict.sequence, u32::MAX);
        let slot = pool.recycle().unwrap();
        assert!(pool.finish(slot, frame(2)));
        assert_eq!(pool.lease(Order::Oldest).unwrap().verdict.sequence, 1, "0 was recycled");
    }

    proptest! {
        /// Any order of calls, with right and wrong slots: each buffer is in one place, and frames leave in order.
        #[test]
        fn no_buffer_is_in_two_places(calls in prop::collection::vec((0_u8..7, 0_usize..5), 1..200)) {
            let mut pool = FramePool::<4>::new();
            let (mut filling, mut ready, mut leased) = (vec![], vec![], vec![]);
            let mut sequence = 0;
            for (call, slot) in calls {
                match call {
                    0 | 1 => {
                        let claimed = if call == 0 { pool.claim() } else {
                            prop_assert_eq!(pool.has_ready(), !ready.is_empty());
                            pool.recycle().inspect(|&slot| prop_assert_first(&mut ready, slot))
                        };
                        filling.extend(claimed);
                    }
                    2 => {
                        let known = filling.iter().position(|&one| one == slot);
                        prop_assert_eq!(pool.finish(slot, frame(sequence)), known.is_some());
                        if let Some(index) = known {
                            ready.push((sequence, filling.swap_remove(index)));
                            sequence += 1;
                        }
                    }
                    3 => {
                        let known = filling.iter().position(|&one| one == slot);
                        prop_assert_eq!(pool.abandon(slot), known.is_some());
                        known.map(|index| filling.swap_remove(index));
                    }
                    4 => {
                        let expected = ready.first().copied();
                        let lease = pool.lease(Order::Oldest);
                        prop_assert_eq!(lease.map(|lease| (lease.verdict.sequence, lease.slot)), expected);
                        if lease.is_some() {
                            leased.push(ready.remove(0).1);
                        }
                    }
                    5 => {
                        let lease = pool.lease(Order::Newest);
                        prop_assert_eq!(lease.map(|lease| (lease.verdict.sequence, lease.slot)), ready.last().copied());
                        if let Some(lease) = lease {
                            prop_assert_eq!(lease.recycled as usize + 1, ready.len());
                            leased.push(lease.slot);
                            ready.clear();
                        }
                    }
                    _ => {
                        let known = leased.iter().position(|&one| one == slot);
                        prop_assert_eq!(pool.release(slot), known.is_some());
                        known.map(|index| leased.swap_remove(index));
                    }
                }
                prop_assert_eq!(pool.free() + filling.len() + ready.len() + leased.len(), 4);
            }
        }
    }

    fn prop_assert_first(ready: &mut Vec<(u32, usize)>, slot: usize) {
        assert_eq!(ready.remove(0).1, slot, "the oldest is recycled");
    }
}
