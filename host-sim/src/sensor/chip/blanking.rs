use crate::profile::Timing;

/// A frame's time in an array's lines, and what of it is picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lines {
    /// Pixel clocks of one line of the array.
    pub(super) line: u64,
    /// Lines of the array in a frame, blanking and all.
    pub(super) total: u64,
    /// Lines of the array that are picture.
    pub(super) active: u64,
    /// Lines from the end of VSYNC to the first of them.
    pub(super) back: u64,
    /// Lines of VSYNC.
    pub(super) sync: u64,
}

impl Lines {
    /// The timing of `height` output lines of `clocks` pixel clocks each, spread evenly over the array's lines: a scaler
    /// that takes 600 lines to 480 sends them less evenly, but with the same mean.
    ///
    /// `None` if the lines are too short for their data, or the frame for its lines.
    pub(super) fn timing(&self, pclk_hz: u32, height: u32, clocks: u32) -> Option<Timing> {
        let height = u64::from(height);
        let period = self.active.checked_mul(self.line)?.checked_div(height)?;
        let hblank = period.checked_sub(u64::from(clocks)).filter(|&clocks| clocks > 0)?;
        let vblank = (self.total * self.line).checked_sub(height * period - hblank)?;
        let vback = self.back * self.line;
        let vfront = vblank.checked_sub(vback + self.sync * self.line)?;
        let fits = |clocks: u64| u32::try_from(clocks).ok();
        (vfront + vback < vblank).then_some(())?;
        Some(Timing {
            pclk_hz,
            hblank: fits(hblank)?,
            vblank: fits(vblank)?,
            vfront: fits(vfront)?,
            vback: fits(vback)?,
        })
    }
}
