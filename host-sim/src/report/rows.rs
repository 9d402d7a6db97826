//! Which pixel clock a row of a picture begins at. DMA writes line after line without a gap, so after a line that is too
//! short or too long every row of the picture begins within a line of the trace:
//!
//! ```text
//! lines  ABCD EFG HIJK LMNO        rows  ABCD   row 1 begins at E, row 2 at I, the second sample of the third line
//!             ▲ a sample is lost         EFGH
//!                                        IJKL
//! ```

use crate::diagnosis::{CutFrame, CutLine};

/// The lines that a picture is made of.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Rows {
    lines: Vec<CutLine>,
    /// Samples before each line, and at the end all.
    before: Vec<u64>,
    samples_a_row: u64,
    height: u64,
}

impl Rows {
    pub(super) fn new(frame: &CutFrame, samples_a_row: u32, height: u32) -> Self {
        let mut before = vec![0];
        let mut sum = 0;
        for line in &frame.lines {
            sum += line.samples;
            before.push(sum);
        }
        let (samples_a_row, height) = (u64::from(samples_a_row.max(1)), u64::from(height));
        Self { lines: frame.lines.clone(), before, samples_a_row, height }
    }

    /// The pixel clock of the first sample of a row; nothing if the frame ended before.
    pub(super) fn clock_of(&self, row: u64) -> Option<u64> {
        self.clock_of_sample(row * self.samples_a_row)
    }

    /// The pixel clock of a sample of the frame, from 0; nothing if the frame ended before.
    pub(super) fn clock_of_sample(&self, sample: u64) -> Option<u64> {
        let line = self.before.partition_point(|&before| before <= sample).checked_sub(1)?;
        self.lines.get(line).map(|cut| cut.start + sample - self.before[line])
    }

    /// The row in which a pixel clock shows; in blanking the one after it, or the last.
    pub(super) fn row_of(&self, clock: u64) -> Option<u64> {
        let last = self.before.last()?.checked_sub(1)?;
        let line = self.lines.partition_point(|line| line.start + line.samples <= clock);
        let sample = match self.lines.get(line) {
            Some(cut) => self.before[line] + clock.saturating_sub(cut.start),
            None => last,
        };
        Some((sample / self.samples_a_row).min(self.height.saturating_sub(1)))
    }

    /// The clocks at which all rows begin.
    pub(super) fn clocks(&self) -> Vec<Option<u64>> {
        (0..self.height).map(|row| self.clock_of(row)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws lines as runs of `#` in blanking.
    fn frame(picture: &str) -> CutFrame {
        let mut lines = Vec::new();
        for (clock, level) in picture.bytes().enumerate() {
            let (clock, data) = (clock as u64, level == b'#');
            match lines.last_mut() {
                Some(CutLine { start, samples }) if data && *start + *samples == clock => *samples += 1,
                _ if data => lines.push(CutLine { start: clock, samples: 1 }),
                _ => {}
            }
        }
        CutFrame { end: None, lines }
    }

    #[test]
    fn rows_begin_where_lines_do_until_one_is_short() {
        let whole = Rows::new(&frame("..####..####..####.."), 4, 3);
        assert_eq!(whole.clocks(), [Some(2), Some(8), Some(14)]);
        let short = Rows::new(&frame("..####..###..####..."), 4, 3);
        assert_eq!(short.clocks(), [Some(2), Some(8), Some(14)], "row 2 begins one sample late in line 2");
        let long = Rows::new(&frame("..#####.####..####.."), 4, 4);
        assert_eq!(long.clocks(), [Some(2), Some(6), Some(11), Some(17)]);
        assert_eq!(Rows::new(&frame("..####.."), 4, 2).clocks(), [Some(2), None]);
        assert_eq!(Rows::new(&frame("...."), 4, 1).clocks(), [None]);
    }

    #[test]
    fn every_clock_is_in_its_row() {
        let rows = Rows::new(&frame("..####..###..####..."), 4, 3);
        let found: Vec<u64> = (0..20).map(|clock| rows.row_of(clock).unwrap()).collect();
        assert_eq!(found, [0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2]);
        for row in 0..3 {
            assert_eq!(rows.row_of(rows.clock_of(row).unwrap()), Some(row));
        }
        assert_eq!(Rows::new(&frame("...."), 4, 1).row_of(2), None);
    }
}
