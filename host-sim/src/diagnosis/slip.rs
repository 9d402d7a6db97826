//! Bytes that slip: the end of each line is idle bus, or belongs to the next line.

use super::data::Data;
use super::finding::{Evidence, Finding};
use super::planes::period;
use super::structure::found;
use crate::fault::FaultKind;
use crate::profile::SyncMode;

impl Data<'_> {
    /// Lines whose end is not theirs.
    pub(super) fn slip(&self) -> Option<Finding> {
        let step = period(self.profile.frame.format);
        let (width, height) = (self.matrix.width, self.matrix.height());
        let found_slip = |samples: usize, text: String, numbers: Evidence| {
            let evidence = Evidence { text, ..numbers }.with("samples", samples as f64);
            found(FaultKind::ByteSlip, 0.97, self.at, evidence, self.remedy(FaultKind::ByteSlip))
        };
        if width < 4 * step + 32 {
            return None;
        }
        if self.profile.bus.sync != SyncMode::Marker {
            // The bus is idle there: each column holds one value in all lines.
            let embedded = self.profile.bus.sync == SyncMode::Embedded;
            let last = self.matrix.line(0)[width - 1];
            let idle = |back: usize| {
                // Filler alternates; a wire without data keeps its level.
                let value = if embedded {
                    [0x80, 0x10][usize::from(back.is_multiple_of(2) != (last == 0x80))]
                } else {
                    last
                };
                (0..height).all(|y| self.matrix.line(y)[width - 1 - back] == value)
            };
            let slipped = (0..32).take_while(|back| idle(*back)).count();
            if slipped == 0 || slipped >= 32 {
                return None;
            }
            let column = |column: usize| (0..height).map(move |y| f64::from(self.matrix.line(y)[column]));
            let end = f64::from(self.matrix.line(0)[width - slipped]);
            let near = width - slipped - step;
            let apart = column(near).map(|value| (value - end).abs()).sum::<f64>() / height as f64;
            let range = f64::from(1u16 << self.matrix.bits);
            // Filler between codes has the value of no colour: a picture without any ends like that as well.
            let least = if embedded { 2.0 } else { 0.04 * range };
            if apart < least {
                return None;
            }
            let text = format!("the last {slipped} samples of every line are {end:.0}, as the idle bus is");
            return Some(found_slip(slipped, text, Evidence::default().with("distance", apart)));
        }
        // Every clock carries data: the end of a line goes on in the next one.
        let distance = |a: u16, b: u16| f64::from(a.abs_diff(b));
        let mut best = (0.0, 0, 0.0, 0.0);
        for samples in 1..=16usize {
            let (mut within, mut across, mut count) = (0.0, 0.0, 0.0);
            for y in 0..height - 1 {
                let (line, next) = (self.matrix.line(y), self.matrix.line(y + 1));
                for lane in 0..step.min(samples) {
                    let at = width - samples + lane;
                    let Some(following) = (at + step).checked_sub(width) else { continue };
                    within += distance(line[at], line[at - step]);
                    across += distance(line[at], next[following]);
                    count += 1.0;
                }
            }
            let ratio = within / f64::max(across, count);
            if count > 0.0 && ratio > best.0 {
                best = (ratio, samples, within / count, across / count);
            }
        }
        let (ratio, samples, within, across) = best;
        let range = f64::from(1u16 << self.matrix.bits);
        (ratio > 1.6 && within > 0.03 * range).then(|| {
            let text = format!(
                "the last {samples} samples of a line go on in the next line: {across:.1} levels apart there, {within:.1} from their neighbours"
            );
            found_slip(samples, text, Evidence::default().with("levels_within", within).with("levels_across", across))
        })
    }
}
