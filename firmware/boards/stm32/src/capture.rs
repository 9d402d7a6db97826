//! What a board does while its sensor sends: frames out, commands in, until the sensor is to be programmed anew.

use firmware::driver::deadline::{Cause, Timeout};
use firmware::driver::verdict::Statistics;
use firmware::driver::{Config, Frame, FrameCamera, StartError};
use firmware::port::{Port, Registers};
use firmware::station::{Order, Station, Wire};

use crate::device::{CameraBoard, SensorRegisters};

/// Why capture ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ended {
    /// Another mode was chosen.
    Mode,
    /// No frame came in time.
    Timeout(Timeout),
    /// The driver does not start.
    Refused(StartError),
}

/// What became of all frames since power-up.
#[derive(Clone, Copy, Debug, Default)]
pub struct Account {
    /// Their counts.
    pub frames: Statistics,
    /// Why none came in time, when that was last so.
    pub cause: Option<Cause>,
}

/// Captures frames of the mode that is wanted, by `config`, and has them sent. `sleep` sleeps until something happens, a
/// millisecond at most, and returns the time, in microseconds.
///
/// What the line does not take is lost: a device waits for nobody.
pub fn capture<'c, W, R, X, P, const N: usize>(
    station: &mut Station<'_, W, CameraBoard<R, X>>,
    camera: &FrameCamera<'c, P, N>,
    config: &Config,
    account: &mut Account,
    sleep: &mut impl FnMut() -> u64,
) -> Ended
where
    W: Wire,
    R: Registers,
    X: SensorRegisters,
    P: Port<'c>,
{
    let chosen = station.control.board.mode().map(|mode| mode.name);
    let mut earlier = account.frames;
    let mut held: Option<Frame<'_, 'c, P, N>> = None;
    // Since when a frame is waited for, and from when on it is wanted.
    let (mut running, mut waiting, mut due) = (false, None, 0);
    loop {
        let now = sleep();
        if running {
            account.frames = earlier + camera.statistics();
        }
        station.tell(account.frames, account.cause);
        let _ = station.serve();
        if station.control.board.mode().map(|mode| mode.name) != chosen {
            camera.stop();
            station.control.release();
            return Ended::Mode;
        }
        if let Some(order) = station.control.take_order() {
            camera.stop();
            if running {
                account.frames = earlier + camera.statistics();
            }
            (earlier, waiting) = (account.frames, None);
            running = order == Order::Start;
            if running && let Err(refusal) = camera.start(config) {
                return Ended::Refused(refusal);
            }
        }
        if let Some(frame) = &held {
            let _ = station.send_again(frame.bytes());
        }
        if !running || waiting.is_none() && now < due {
            continue;
        }
        let since = *waiting.get_or_insert_with(|| {
            if N == 1 {
                // The only buffer is needed.
                held = None;
                station.control.release();
            }
            camera.trigger();
            now
        });
        if let Some(frame) = camera.try_frame() {
            waiting = None;
            due = now + 1_000 * u64::from(station.control.period_ms());
            let frame = held.insert(frame);
            let _ = station.frame(frame.bytes(), frame.verdict());
        } else if now.saturating_sub(since) > 1_000 * u64::from(station.control.board.deadline_ms()) {
            let timeout = camera.diagnose();
            camera.stop();
            *account = Account { frames: earlier + camera.statistics(), cause: Some(timeout.cause) };
            station.tell(account.frames, account.cause);
            station.control.release();
            return Ended::Timeout(timeout);
        }
    }
}
