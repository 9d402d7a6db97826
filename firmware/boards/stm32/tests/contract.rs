//! One driver, two implementations of the seam: the block's own model, and DCMI with a DMA stream modelled register by register
//! from the manuals. What the wires bring arrives the same through both.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Range;

use firmware::camif::pins::{Samples, Sync};
use firmware::camif::registers::{Events, Register, Registers, Status};
use firmware::camif::{Bus, Camif, Part};
use firmware::driver::config::{Damaged, Policy, SyncMode};
use firmware::driver::verdict::{Outcome, Statistics};
use firmware::driver::{Config, FrameCamera, StartError, frame_plan};
use firmware::port::{Burst, Dma, DmaError, DmaMode, Port, Target, Transfer};
use stm32::chip::{Chip, Request, STM32F429, STM32H743};
use stm32::port::DcmiPort;
use stm32::silicon::Silicon;
use stm32::stream::{self, Stream};

const DOUBLE: u32 = 1 << 18;
const CIRCULAR: u32 = 1 << 8;

/// DCMI, a DMA controller and memory, at the chip's addresses.
struct Board {
    chip: Chip,
    stream: Stream,
    camif: Camif<'static>,
    /// The registers of the DMA that are plain memory.
    registers: BTreeMap<u32, u32>,
    /// NDTR as it counts down.
    count: u32,
    /// The stream's flags, at bit 0.
    flags: u32,
    /// The memory, and where the DMA finds it.
    memory: *mut u32,
    words: usize,
    base: u32,
}

impl Board {
    /// With this memory at the start of what the DMA reaches, or out of its reach.
    fn new(chip: Chip, memory: &mut [u32], base: u32) -> Self {
        let stream = Stream { dma: chip.dma, number: chip.stream };
        let camif = Camif::new(chip.part, Bus::IDEAL);
        let (words, memory) = (memory.len(), memory.as_mut_ptr());
        let registers = BTreeMap::new();
        Self { chip, stream, camif, registers, count: 0, flags: 0, memory, words, base }
    }

    fn get(&self, address: u32) -> u32 {
        self.registers.get(&address).copied().unwrap_or(0)
    }

    /// The stream takes what DCMI has.
    fn serve_requests(&mut self) {
        let control = self.stream.control();
        loop {
            let word_waits = Status::new_with_raw_value(self.camif.read(Register::Status)).fifo_not_empty();
            let value = self.get(control);
            if !word_waits || value & stream::ENABLE == 0 || !self.is_requested() {
                return;
            }
            assert_eq!(self.get(self.stream.peripheral()), self.chip.dcmi + 0x28, "from DR");
            let target = usize::from(value & stream::CURRENT_TARGET != 0);
            let length = self.get(self.stream.count());
            let address = self.get(self.stream.memory(target)) + 4 * (length - self.count);
            let word = self.camif.read(Register::Data);
            let index = (address - self.base) as usize / 4;
            assert!(index < self.words, "the DMA writes within the memory");
            // SAFETY: `index` is within the memory.
            let place = unsafe { self.memory.add(index) };
            // SAFETY: the test holds the memory, and the driver has lent this part of it.
            unsafe { place.write(word) };
            self.count -= 1;
            if self.count == length / 2 {
                self.flags |= 1 << 4;
            }
            if self.count == 0 {
                self.flags |= 1 << 5;
                if value & DOUBLE != 0 {
                    self.registers.insert(control, value ^ stream::CURRENT_TARGET);
                }
                if value & (DOUBLE | CIRCULAR) != 0 {
                    self.count = length;
                } else {
                    self.registers.insert(control, value & !stream::ENABLE);
                }
            }
        }
    }

    /// DCMI's request reaches the stream, by the manuals' tables and not by the port's.
    fn is_requested(&self) -> bool {
        match (self.chip.part.name, self.chip.dma, self.chip.stream) {
            // RM0090 table 43: DCMI is channel 1 of DMA2's streams 1 and 7.
            ("STM32F4", 0x4002_6400, 1 | 7) => self.get(self.stream.control()) >> 25 & 7 == 1,
            // RM0433 ch. 17: DMAMUX1 has a register for each stream of DMA1 and then of DMA2; DCMI is request 75.
            ("STM32H7", 0x4002_0000, stream) => self.get(0x4002_0800 + 4 * stream) == 75,
            ("STM32H7", 0x4002_0400, stream) => self.get(0x4002_0820 + 4 * stream) == 75,
            _ => false,
        }
    }

    fn interrupts(&mut self) -> bool {
        let enabled = self.get(self.stream.control());
        // TEIE, HTIE and TCIE stand one bit below their flags.
        self.camif.read(Register::MaskedInterrupt) & Events::MASK != 0
            || self.flags & enabled << 1 & 0b11_1000 != 0
    }
}

/// The board as the port sees it.
#[derive(Clone, Copy)]
struct Shared<'a>(&'a RefCell<Board>);

impl Silicon for Shared<'_> {
    fn read(&mut self, address: u32) -> u32 {
        let mut board = self.0.borrow_mut();
        let offset = address.wrapping_sub(board.chip.dcmi);
        if let Some(register) = Register::at(offset).filter(|register| *register <= Register::Data) {
            board.serve_requests();
            return board.camif.read(register);
        }
        match address {
            _ if address == board.stream.count() => board.count,
            _ if address == board.stream.status() => board.flags << board.stream.shift(),
            _ => board.get(address),
        }
    }

    fn write(&mut self, address: u32, value: u32) {
        let mut board = self.0.borrow_mut();
        let offset = address.wrapping_sub(board.chip.dcmi);
        if let Some(register) = Register::at(offset).filter(|register| *register <= Register::Data) {
            board.camif.write(register, value);
            return;
        }
        let (stream, control) = (board.stream, board.get(board.stream.control()));
        let enabled = control & stream::ENABLE != 0;
        if address == stream.clear() {
            board.flags &= !(value >> stream.shift());
            return;
        }
        for target in [0, 1] {
            let in_use = usize::from(control & stream::CURRENT_TARGET != 0) == target;
            assert!(
                address != stream.memory(target) || !enabled || control & DOUBLE != 0 && !in_use,
                "the address of a target in use is not to be written (RM0090 §10.3.9)"
            );
        }
        if address == stream.count() {
            assert!(!enabled, "NDTR is written while the stream is off");
            assert!((1..=65_535).contains(&value));
            board.count = value;
        }
        if address == stream.control() {
            assert!(!enabled || (control ^ value) & !stream::ENABLE == 0, "CR is written while it is off");
            if !enabled && value & stream::ENABLE != 0 {
                assert_eq!(board.flags, 0, "flags are cleared before a start (RM0090 §10.3.17)");
            }
            if enabled && value & stream::ENABLE == 0 {
                // A stream that is turned off says so by TCIF.
                board.flags |= 1 << 5;
            }
        }
        board.registers.insert(address, value);
    }

    fn address(&self, memory: *const u32) -> u32 {
        let board = self.0.borrow();
        board.base + (memory.addr() - board.memory.addr()) as u32
    }
}

/// Frames of 8-bit samples with blanking, as a gated sensor sends them.
struct Wires<'a> {
    play: &'a mut dyn FnMut(Sync, &[u8]),
}

impl Wires<'_> {
    fn frame(&mut self, bytes: &[u8], line: usize) {
        (self.play)(Sync { hsync: true, vsync: true }, &[0; 64]);
        for line in bytes.chunks(line) {
            (self.play)(Sync { hsync: true, vsync: false }, &[0; 16]);
            (self.play)(Sync { hsync: false, vsync: false }, line);
        }
        (self.play)(Sync { hsync: true, vsync: false }, &[0; 16]);
        (self.play)(Sync { hsync: true, vsync: true }, &[0; 64]);
    }
}

fn picture(number: usize, bytes: usize) -> Vec<u8> {
    (0..bytes).map(|at| (at * 7 + number * 31 + (at >> 8) * 13) as u8).collect()
}

type Frames = Vec<(Outcome, Vec<u8>)>;

/// What is done with a port of each kind: sends `sent` through a camera with `N` buffers.
struct Bench {
    config: Config,
    sent: Vec<Vec<u8>>,
}

impl Bench {
    fn new(line: u32, lines: u32, frames: usize, policy: Policy) -> Self {
        let sync = SyncMode::Gated { hsync_blank_high: true, vsync_blank_high: true };
        let mut config = Config::new(sync, line, lines);
        (config.policy, config.damaged) = (policy, Damaged::Deliver);
        let bytes = (line * lines) as usize;
        Self { config, sent: (0..frames).map(|number| picture(number, bytes)).collect() }
    }

    fn room(&self, part: &Part) -> usize {
        frame_plan(&self.config, part.transfer_limit).unwrap().room() as usize
    }

    fn take<'m, P: Port<'m>, const N: usize>(camera: &FrameCamera<'m, P, N>, received: &mut Frames) {
        while let Some(frame) = camera.try_frame() {
            received.push((frame.verdict().outcome, frame.bytes().to_vec()));
        }
    }

    fn send<'m, P: Port<'m>, const N: usize>(
        &self,
        camera: &FrameCamera<'m, P, N>,
        play: &mut dyn FnMut(Sync, &[u8]),
    ) -> (Frames, Statistics) {
        let mut received = Vec::new();
        camera.start(&self.config).unwrap();
        for frame in &self.sent {
            camera.trigger();
            Wires { play }.frame(frame, self.config.line_clocks as usize);
            Self::take(camera, &mut received);
        }
        (received, camera.statistics())
    }

    /// Through the block's own model, of this part.
    fn through_the_model<const N: usize>(&self, part: Part) -> (Frames, Statistics) {
        let mut memory: [Vec<u32>; N] = std::array::from_fn(|_| vec![0; self.room(&part)]);
        let model = RefCell::new(Camif::new(part, Bus::IDEAL));
        let camera = FrameCamera::new(&model, memory.each_mut().map(Vec::as_mut_slice)).unwrap();
        self.send(&camera, &mut |sync, bytes| {
            let mut samples = Samples::Bytes(bytes);
            while !samples.is_empty() {
                let played = model.borrow_mut().run(sync, samples);
                samples = samples.skip(played);
                camera.on_interrupt();
            }
        })
    }

    /// Through the stream of DMA1 or DMA2.
    fn through_the_stream<const N: usize>(&self, chip: &Chip) -> (Frames, Statistics) {
        let room = self.room(&chip.part);
        let mut memory = vec![0; N * room];
        // The first memory that is large enough.
        let fits = |range: &&Range<u32>| range.len() >= 4 * memory.len();
        let base = chip.reach.iter().find(fits).unwrap().start;
        let board = RefCell::new(Board::new(chip.clone(), &mut memory, base));
        let pointer = board.borrow().memory;
        let buffers: [&mut [u32]; N] = std::array::from_fn(|index| {
            // SAFETY: the memory has N parts of this many words.
            let part = unsafe { pointer.add(index * room) };
            // SAFETY: no part is taken twice; the board writes through the same pointer.
            unsafe { std::slice::from_raw_parts_mut(part, room) }
        });
        let camera = FrameCamera::new(DcmiPort::new(Shared(&board), chip.clone()), buffers).unwrap();
        self.send(&camera, &mut |sync, bytes| {
            // No more at a time than the FIFO holds.
            for samples in bytes.chunks(4) {
                let mut samples = Samples::Bytes(samples);
                while !samples.is_empty() {
                    let played = board.borrow_mut().camif.run(sync, samples);
                    samples = samples.skip(played);
                    board.borrow_mut().serve_requests();
                    for round in 0.. {
                        if !board.borrow_mut().interrupts() {
                            break;
                        }
                        assert!(round < 32, "an interrupt stays high");
                        camera.on_interrupt();
                    }
                }
            }
        })
    }
}

#[test]
fn frames_arrive_as_through_the_model() {
    for chip in [STM32F429, STM32H743] {
        for (line, lines) in [(64, 8), (20, 3), (320, 24), (36, 5)] {
            let bench = Bench::new(line, lines, 5, Policy::InOrder);
            let through = bench.through_the_stream::<3>(&chip);
            assert_eq!(
                through,
                bench.through_the_model::<3>(chip.part),
                "{} {line} × {lines}",
                chip.part.name
            );
            let expected: Frames = bench.sent.iter().map(|sent| (Outcome::Good, sent.clone())).collect();
            assert!(through.0 == expected, "{} {line} × {lines}", chip.part.name);
        }
    }
}

#[test]
fn a_frame_longer_than_a_transfer_is_cut() {
    // 76,800 words, where a transfer has 65,535 at most.
    let bench = Bench::new(1_024, 300, 3, Policy::InOrder);
    for chip in [STM32F429, STM32H743] {
        let (received, statistics) = bench.through_the_stream::<2>(&chip);
        assert!(received.iter().zip(&bench.sent).all(|(received, sent)| received.1 == *sent));
        assert_eq!((received.len(), statistics.delivered), (3, 3), "{}", chip.part.name);
    }
}

#[test]
fn one_buffer_is_enough_for_snapshots() {
    let bench = Bench::new(640, 24, 4, Policy::Snapshot);
    for chip in [STM32F429, STM32H743] {
        let through = bench.through_the_stream::<1>(&chip);
        assert_eq!(through, bench.through_the_model::<1>(chip.part), "{}", chip.part.name);
        assert!(!through.0.is_empty() && through.0.iter().all(|frame| frame.0.is_good()));
    }
}

#[test]
fn the_target_in_use_stays_where_it_is() {
    let chip = STM32F429;
    let (mut memory, base) = (vec![0; 64], chip.reach[0].start);
    let board = RefCell::new(Board::new(chip.clone(), &mut memory, base));
    let pointer = board.borrow().memory;
    // SAFETY: the only reference to the memory; the board does not write, for no data comes.
    let buffer = unsafe { std::slice::from_raw_parts_mut(pointer, 64) };
    let mut port = DcmiPort::new(Shared(&board), chip);
    port.lend(0, buffer).unwrap();
    port.aim(Target::Zero, 0, 0).unwrap();
    port.aim(Target::One, 0, 16).unwrap();
    let (mode, burst) = (DmaMode::Double, Burst::Four);
    port.start(Transfer { words: 16, mode, burst, line_by_line: false, half_interrupt: false }).unwrap();
    let addresses = || [0, 1].map(|target| board.borrow().get(board.borrow().stream.memory(target)) - base);
    assert_eq!(addresses(), [0, 64]);
    // The board asserts that the register of the target in use is not written.
    port.aim(Target::Zero, 0, 32).unwrap();
    assert_eq!((addresses(), port.target()), ([0, 64], Target::Zero), "the caller sees that it was late");
    port.aim(Target::One, 0, 32).unwrap();
    assert_eq!(addresses(), [0, 128]);
    assert_eq!(
        port.aim(Target::One, 0, 56),
        Err(DmaError::OutOfBounds { slot: 0, needed: 72, lent: 64 }),
        "a transfer that does not fit is not aimed"
    );
    assert!(port.take_back(0).is_none(), "the DMA has it");
    port.stop();
    assert_eq!(port.take_back(0).map(|buffer| buffer.len()), Some(64));
}

#[test]
fn memory_out_of_the_dmas_reach_is_refused() {
    for (chip, tightly_coupled) in [(STM32F429, 0x1000_0000), (STM32H743, 0x2000_0000)] {
        let mut memory = vec![0; 1_024];
        let board = RefCell::new(Board::new(chip.clone(), &mut memory, tightly_coupled));
        let pointer = board.borrow().memory;
        // SAFETY: the only reference to the memory; the board does not write before a start.
        let buffer = unsafe { std::slice::from_raw_parts_mut(pointer, 1_024) };
        let camera = FrameCamera::new(DcmiPort::new(Shared(&board), chip), [buffer]).unwrap();
        let bench = Bench::new(64, 8, 1, Policy::InOrder);
        let error = camera.start(&bench.config).unwrap_err();
        assert!(matches!(error, StartError::Dma(DmaError::Unsupported { .. })), "{error}");
        assert!(error.to_string().contains("DTCM"), "{error}");
    }
}

#[test]
fn a_stream_that_gets_no_requests_is_told() {
    use firmware::driver::deadline::Cause;
    // DMAMUX is set to another request after the port has set it.
    let chip = STM32H743;
    let Request::Multiplexer { register, .. } = chip.request else { panic!("H7 has a multiplexer") };
    let mut memory = vec![0; 1_024];
    let board = RefCell::new(Board::new(chip.clone(), &mut memory, chip.reach[0].start));
    let pointer = board.borrow().memory;
    // SAFETY: the only reference to the memory; the board writes while it is lent.
    let buffer = unsafe { std::slice::from_raw_parts_mut(pointer, 1_024) };
    let camera = FrameCamera::new(DcmiPort::new(Shared(&board), chip), [buffer]).unwrap();
    board.borrow_mut().registers.insert(register, 74);
    let bench = Bench::new(64, 8, 1, Policy::InOrder);
    camera.start(&bench.config).unwrap();
    for _ in 0..3 {
        let mut play = |sync, bytes: &[u8]| {
            board.borrow_mut().camif.run(sync, Samples::Bytes(bytes));
            camera.on_interrupt();
        };
        Wires { play: &mut play }.frame(&bench.sent[0], 64);
    }
    assert_eq!(camera.diagnose().cause, Cause::DmaStalled);
}
