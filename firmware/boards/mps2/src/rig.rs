//! The camera on this board: the block's model, clocked from a timer's interrupt, whose own interrupt is a real one.
//!
//! ```text
//! TIMER0 ──► a stretch of the trace ──► block ──► pends CAMIF ──► the driver's handler
//! priority low                          model     priority high   preempts the timer's
//!
//! main: wfe ─► a tick has passed ─► frames and lines
//! ```

use core::cell::{Cell, RefCell, RefMut};

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use critical_section::{CriticalSection, Mutex};
use exercise::replay::consumer::END;
use exercise::replay::player::{Clocked, Player, Tick};
use exercise::replay::record::{Access, Log, Record, Recorded};
use firmware::camif::pins::{Samples, Sync};
use firmware::camif::{Bus, Camif, Part};
use firmware::port::{Dma, DmaError, DmaEvents, Port, Register, Registers, Target, Transfer};
use firmware::trace::ChunkBuffer;

use crate::exit;
use crate::file::Input;

/// Interrupts of this board that are in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Line {
    /// CMSDK timer 0.
    Timer0 = 8,
    /// CMSDK timer 1: the time.
    Timer1 = 9,
    /// No device of the board: the block's, which the model pends.
    Camif = 30,
}

// SAFETY: all are numbers of interrupts that the NVIC of these boards has (it has 32), and they don't change.
unsafe impl InterruptNumber for Line {
    fn number(self) -> u16 {
        self as u16
    }
}

/// Timer clocks from falling asleep to the tick: 40 instructions each. The timer stands still while main works, as a sensor
/// does whose clock is gated, so that what happens in which order does not depend on how fast main is; QEMU runs `wfe` as a
/// loop, and a longer time would only be instructions spent in it.
const TIMER_RELOAD: u32 = 25;

/// Registers of CMSDK timer 0 (Arm DDI0479, 3.5): control, value, reload, interrupt status and clear.
const TIMER_CONTROL: *mut u32 = 0x4000_0000 as *mut u32;
const TIMER_RELOAD_REGISTER: *mut u32 = 0x4000_0008 as *mut u32;
const TIMER_CLEAR: *mut u32 = 0x4000_000C as *mut u32;

type Trace = Player<'static, Input, &'static mut ChunkBuffer>;

static BLOCK: Mutex<RefCell<Option<Camif<'static>>>> = Mutex::new(RefCell::new(None));
static RECORD: Mutex<RefCell<Record>> = Mutex::new(RefCell::new(Record::new()));
static PLAYER: Mutex<RefCell<Option<Trace>>> = Mutex::new(RefCell::new(None));
static TICKS: Mutex<Cell<u64>> = Mutex::new(Cell::new(0));
static HANDLER: Mutex<Cell<Option<&'static dyn Handler>>> = Mutex::new(Cell::new(None));

/// Serves the block's interrupt. Only the interrupt calls it.
pub trait Handler: core::marker::Sync {
    /// The block's interrupt line is high.
    fn on_interrupt(&self);
}

/// What is shared, for as long as nobody disturbs.
fn hold<'s, T>(shared: &'s Mutex<RefCell<T>>, section: CriticalSection<'s>) -> RefMut<'s, T> {
    match shared.borrow(section).try_borrow_mut() {
        Ok(held) => held,
        Err(_) => {
            defmt::error!("the rig is in use already");
            exit::failure()
        }
    }
}

/// Puts a block at rest in place, and forgets what was recorded.
pub fn install(bus: Bus) {
    critical_section::with(|section| {
        *hold(&BLOCK, section) = Some(Camif::new(Part::CAMIF, bus));
        *hold(&RECORD, section) = Record::new();
        TICKS.borrow(section).set(0);
    });
}

/// What the driver did so far.
#[must_use]
pub fn record() -> Record {
    critical_section::with(|section| *hold(&RECORD, section))
}

/// Plays `trace` a stretch a tick, with `handler` for the block's interrupt, while `body` runs. The player comes back.
pub fn play<R>(trace: Trace, handler: &dyn Handler, body: impl FnOnce() -> R) -> (R, Option<Trace>) {
    // SAFETY: the reference does not outlive this call: it is taken out of HANDLER below, before `handler` can go, and
    // nobody copies it out of there but the interrupt, which has returned by then.
    let handler: &'static dyn Handler = unsafe { core::mem::transmute(handler) };
    critical_section::with(|section| {
        *hold(&PLAYER, section) = Some(trace);
        TICKS.borrow(section).set(0);
        HANDLER.borrow(section).set(Some(handler));
    });
    start();
    let result = body();
    stop();
    let player = critical_section::with(|section| {
        HANDLER.borrow(section).set(None);
        hold(&PLAYER, section).take()
    });
    (result, player)
}

fn start() {
    // SAFETY: the handlers are in place, and no critical section relies on a masked interrupt.
    unsafe { NVIC::unmask(Line::Timer0) };
    // SAFETY: as above.
    unsafe { NVIC::unmask(Line::Camif) };
}

fn stop() {
    // SAFETY: as in `start`; disables the timer.
    unsafe { TIMER_CONTROL.write_volatile(0) };
    NVIC::mask(Line::Timer0);
    NVIC::mask(Line::Camif);
    NVIC::unpend(Line::Timer0);
    NVIC::unpend(Line::Camif);
}

/// Sets the priorities: the block's interrupt comes through the timer's.
pub fn prioritize(nvic: &mut NVIC) {
    // SAFETY: priorities change before either interrupt is unmasked, and no critical section goes by priority.
    unsafe { nvic.set_priority(Line::Timer0, 0xC0) };
    // SAFETY: as above.
    unsafe { nvic.set_priority(Line::Camif, 0x40) };
    // SAFETY: as above; the same as the timer's, so that neither comes through the other.
    unsafe { nvic.set_priority(Line::Timer1, 0xC0) };
}

/// Sleeps until the next tick, and returns its number; [`END`] after the last.
pub fn sleep(before: u64) -> u64 {
    // SAFETY: these are the timer's registers by the boards' memory map, written whole, while the timer stands still and
    // its interrupt cannot write them.
    unsafe { TIMER_RELOAD_REGISTER.write_volatile(TIMER_RELOAD) };
    // SAFETY: as above; enables timer and interrupt.
    unsafe { TIMER_CONTROL.write_volatile(0b1001) };
    loop {
        let now = critical_section::with(|section| TICKS.borrow(section).get());
        if now == END || now > before {
            return now;
        }
        cortex_m::asm::wfe();
    }
}

/// An interrupt came.
pub(crate) fn dispatch(number: i16) -> bool {
    if number == Line::Timer0 as i16 {
        // SAFETY: the timer's register by the boards' memory map; it stands still until main sleeps again, and main does not
        // write it meanwhile.
        unsafe { TIMER_CONTROL.write_volatile(0) };
        // SAFETY: as above; acknowledges its interrupt.
        unsafe { TIMER_CLEAR.write_volatile(1) };
        tick();
    } else if number == Line::Timer1 as i16 {
        crate::uptime::on_interrupt();
    } else if number == Line::Camif as i16 {
        let handler = critical_section::with(|section| HANDLER.borrow(section).get());
        if let Some(handler) = handler {
            handler.on_interrupt();
        }
    } else {
        return false;
    }
    true
}

/// The block as the timer's interrupt drives it: borrowed for a run, so that its own interrupt can come between two.
struct Wires;

impl Clocked for Wires {
    fn run(&mut self, sync: Sync, samples: Samples<'_>) -> (usize, bool) {
        with(|camif| {
            let played = camif.run(sync, samples);
            (played, camif.interrupts().any())
        })
        .unwrap_or((samples.len(), false))
    }

    fn interrupt(&mut self) {
        NVIC::pend(Line::Camif);
        // Unless it is masked, the handler has run when these are done: its priority is higher.
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
    }

    fn mask(&mut self, masked: bool) {
        if masked {
            NVIC::mask(Line::Camif);
        } else {
            // SAFETY: its handler is in place while a trace plays, and no critical section relies on a masked interrupt.
            unsafe { NVIC::unmask(Line::Camif) };
        }
        // What is pending has been served when these are done.
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
    }

    fn change_bus(&mut self, bus: Bus) -> Bus {
        with(|camif| core::mem::replace(camif.bus_mut(), bus)).unwrap_or(bus)
    }
}

fn tick() {
    // Taken out while it plays: the block's interrupt comes in between and must not find it borrowed.
    let Some(mut player) = critical_section::with(|section| hold(&PLAYER, section).take()) else {
        return;
    };
    let tick = player.tick(&mut Wires);
    critical_section::with(|section| {
        let ticks = TICKS.borrow(section);
        match tick {
            Tick::Played => ticks.set(ticks.get() + 1),
            Tick::Ended => ticks.set(END),
            Tick::Broken => {
                defmt::error!("the trace is damaged");
                exit::failure()
            }
        }
        *hold(&PLAYER, section) = Some(player);
    });
    // Whoever waits for an event has one.
    cortex_m::asm::sev();
}

fn with<R>(body: impl FnOnce(&mut Camif<'static>) -> R) -> Option<R> {
    critical_section::with(|section| hold(&BLOCK, section).as_mut().map(body))
}

/// The block as the driver sees it.
#[derive(Clone, Copy, Debug)]
pub struct OnBlock;

/// The driver's port: the block, with every access recorded.
pub type Recording = Recorded<OnBlock, Global>;

/// The record of this rig.
#[derive(Clone, Copy, Debug)]
pub struct Global;

impl Log for Global {
    fn note(&mut self, access: Access) {
        critical_section::with(|section| hold(&RECORD, section).note(access));
    }
}

/// A port for a driver.
#[must_use]
pub fn port() -> Recording {
    Recorded { port: OnBlock, log: Global }
}

impl Registers for OnBlock {
    fn read(&mut self, register: Register) -> u32 {
        with(|camif| camif.read(register)).unwrap_or_default()
    }

    fn write(&mut self, register: Register, value: u32) {
        with(|camif| camif.write(register, value));
    }
}

/// What a block that is not there says.
const ABSENT: DmaError = DmaError::Unsupported { what: "block: none was installed" };

impl Dma<'static> for OnBlock {
    fn lend(&mut self, slot: usize, memory: &'static mut [u32]) -> Result<(), &'static mut [u32]> {
        let mut memory = Some(memory);
        let lent = with(|camif| match memory.take() {
            Some(memory) => camif.lend(slot, memory),
            None => Ok(()),
        });
        match (lent, memory) {
            (Some(result), _) => result,
            (None, Some(memory)) => Err(memory),
            (None, None) => Ok(()),
        }
    }

    fn take_back(&mut self, slot: usize) -> Option<&'static mut [u32]> {
        with(|camif| camif.take_back(slot)).flatten()
    }

    fn aim(&mut self, target: Target, slot: usize, start: usize) -> Result<(), DmaError> {
        with(|camif| camif.aim(target, slot, start)).unwrap_or(Err(ABSENT))
    }

    fn start(&mut self, transfer: Transfer) -> Result<(), DmaError> {
        with(|camif| camif.start(transfer)).unwrap_or(Err(ABSENT))
    }

    fn stop(&mut self) {
        with(Dma::stop);
    }

    fn events(&mut self) -> DmaEvents {
        with(Dma::events).unwrap_or_default()
    }

    fn acknowledge(&mut self, events: DmaEvents) {
        with(|camif| camif.acknowledge(events));
    }

    fn target(&mut self) -> Target {
        with(Dma::target).unwrap_or(Target::Zero)
    }

    fn remaining(&mut self) -> u32 {
        with(Dma::remaining).unwrap_or_default()
    }
}

impl Port<'static> for OnBlock {
    fn part(&self) -> Part {
        Part::CAMIF
    }
}
