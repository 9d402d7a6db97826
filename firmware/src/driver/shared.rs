//! What the interrupt handler and the tasks share: the state machine, the time, and who waits.

use core::cell::RefCell;
use core::future::poll_fn;
use core::task::{Context, Poll, Waker};

use critical_section::Mutex;

use super::deadline::Timeout;
use super::machine::Machine;

/// A state machine behind a critical section.
pub(super) struct Shared<M> {
    state: Mutex<RefCell<State<M>>>,
}

/// What is shared.
pub(super) struct State<M> {
    pub(super) machine: M,
    waker: Option<Waker>,
    /// The time when it was last told, in the caller's ticks.
    now: u64,
    /// When the waiting task is to be woken at the latest.
    alarm: u64,
}

impl<M> Shared<M> {
    pub(super) fn new(machine: M) -> Self {
        let state = State { machine, waker: None, now: 0, alarm: u64::MAX };
        Self { state: Mutex::new(RefCell::new(state)) }
    }

    /// Runs `body` on the state, undisturbed. The sections are short: none waits for anything.
    pub(super) fn with<R>(&self, body: impl FnOnce(&mut State<M>) -> R) -> R {
        critical_section::with(|section| body(&mut self.state.borrow_ref_mut(section)))
    }

    /// Runs `body`, and wakes who waits if it says so.
    pub(super) fn with_wake(&self, body: impl FnOnce(&mut M) -> bool) {
        let waker = self.with(|state| if body(&mut state.machine) { state.waker.take() } else { None });
        if let Some(waker) = waker {
            waker.wake();
        }
    }

    /// It is `now`: wakes who has waited long enough.
    pub(super) fn advance(&self, now: u64) {
        let waker = self.with(|state| {
            state.now = state.now.max(now);
            if state.now >= state.alarm { state.waker.take() } else { None }
        });
        if let Some(waker) = waker {
            waker.wake();
        }
    }

    /// Calls `idle`, serves the interrupts and tries to `lease`, over and over until it is `deadline`.
    pub(super) fn wait<'m, R>(
        &self,
        deadline: u64,
        mut idle: impl FnMut() -> u64,
        lease: impl Fn(&mut M) -> Option<R>,
    ) -> Result<R, Timeout>
    where
        M: Machine<'m>,
    {
        loop {
            let now = idle();
            self.with_wake(M::service);
            if let Some(leased) = self.with(|state| lease(&mut state.machine)) {
                return Ok(leased);
            }
            if now >= deadline {
                return Err(self.with(|state| state.machine.diagnose()));
            }
        }
    }

    /// Tries to `lease` whenever woken, until it is `deadline`.
    pub(super) async fn next<'m, R>(
        &self,
        deadline: u64,
        lease: impl Fn(&mut M) -> Option<R>,
    ) -> Result<R, Timeout>
    where
        M: Machine<'m>,
    {
        poll_fn(|context| {
            let (poll, displaced) = self.with(|state| {
                if let Some(leased) = lease(&mut state.machine) {
                    return (Poll::Ready(Ok(leased)), None);
                }
                match state.wait(context, deadline) {
                    Ok(displaced) => (Poll::Pending, displaced),
                    Err(()) => (Poll::Ready(Err(state.machine.diagnose())), None),
                }
            });
            if let Some(waker) = displaced {
                waker.wake();
            }
            poll
        })
        .await
    }

    pub(super) fn into_machine(self) -> M {
        self.state.into_inner().into_inner().machine
    }
}

impl<M> State<M> {
    /// The deadline has passed; if not, the task is woken when it has, or when something happens. Returns the waker that
    /// this one displaces, to be woken so that no task sleeps for ever.
    fn wait(&mut self, context: &Context<'_>, deadline: u64) -> Result<Option<Waker>, ()> {
        if self.now >= deadline {
            return Err(());
        }
        self.alarm = deadline;
        match &self.waker {
            Some(waker) if waker.will_wake(context.waker()) => Ok(None),
            _ => Ok(self.waker.replace(context.waker().clone())),
        }
    }
}
