//! What looks into a run from outside: a debugger, and the image's own log.

mod common;

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::time::{Duration, Instant};

use board_emu::board::Kind;
use board_emu::camera::Camera;
use board_emu::report::{Ending, Report};
use board_emu::run::Plan;
use common::{PCLK_HZ, footage, image};

/// An address that nobody uses at the moment.
fn free_address() -> SocketAddr {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap()
}

/// Connects once somebody listens there.
fn connect(address: SocketAddr) -> TcpStream {
    let until = Instant::now() + Duration::from_secs(60);
    loop {
        match TcpStream::connect(address) {
            Ok(stream) => return stream,
            Err(error) => assert!(Instant::now() < until, "{error}"),
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Runs beside `look`.
fn run(plan: Plan, look: impl FnOnce()) -> Report {
    let running = std::thread::spawn(move || plan.run(None).unwrap());
    look();
    running.join().unwrap()
}

#[test]
fn a_debugger_stops_the_core_at_its_first_instruction_and_lets_it_go() {
    let Some(image) = image("camif-dcmi", Kind::Stm32h743) else { return };
    let (footage, ..) = footage(2, &[]).unwrap();
    let address = free_address();
    let camera = Camera::recorded(footage, PCLK_HZ);
    let plan = Plan { gdb: Some(address), ..Plan::new(Kind::Stm32h743, image, camera) };
    let report = run(plan, || {
        let mut debugger = connect(address);
        // The GDB remote protocol: read register 15, then detach.
        debugger.write_all(b"$pf#d6").unwrap();
        let mut answer = String::new();
        while !answer.contains('#') {
            let mut byte = [0];
            debugger.read_exact(&mut byte).unwrap();
            answer.push(byte[0].into());
        }
        let digits = answer.split(['$', '#']).nth(1).unwrap();
        let program_counter = u32::from_str_radix(digits, 16).unwrap().swap_bytes();
        assert_eq!(program_counter >> 24, 0x08, "{answer}: not in the flash");
        debugger.write_all(b"+$D#44").unwrap();
        // The connection stays until the answer is there.
        let _ = debugger.read(&mut [0; 16]);
    });
    assert_eq!(report.ending, Ending::Done, "{report}");
    assert!(report.is_fine() && report.frames == 2, "{report}");
}

#[test]
fn what_an_image_logs_by_rtt_comes_out_as_defmt_frames() {
    let Some(image) = image("camera_h743", Kind::Stm32h743) else { return };
    let (footage, ..) = footage(2, &[]).unwrap();
    let address = free_address();
    let camera = Camera::recorded(footage, PCLK_HZ);
    // No sensor answers, which the image logs, again and again.
    let plan =
        Plan { rtt: Some(address), deadline: 6_000_000_000, ..Plan::new(Kind::Stm32h743, image, camera) };
    let mut log = Vec::new();
    let report = run(plan, || {
        connect(address).read_to_end(&mut log).unwrap();
    });
    assert_eq!(report.ending, Ending::Dark, "{report}");
    assert!(!report.is_fine(), "an image that never switches the interface on is no success");
    // Each of defmt's frames ends with a zero (its encoding is rzCOBS).
    let frames = log.split(|&byte| byte == 0).filter(|frame| !frame.is_empty()).count();
    assert!(frames >= 1, "{log:?}");
}
