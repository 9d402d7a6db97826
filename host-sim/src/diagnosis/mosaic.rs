//! A mosaic that starts with another colour, or whose neighbours have changed places.

use algos_nostd::pixel::bayer::BayerOrder;

use super::data::{Data, VALUES};
use super::finding::{Evidence, Finding};
use super::structure::found;
use crate::fault::FaultKind;
use crate::profile::Choice;

impl Data<'_> {
    /// A mosaic that starts with another colour: what should be green is not.
    pub(super) fn mosaic(&self) -> Option<Finding> {
        if !self.profile.frame.is_bayer() || self.statistics.values < VALUES {
            return None;
        }
        let order = self.profile.frame.bayer;
        let (width, height) = (self.matrix.width, self.matrix.height());
        let (mut green, mut other, mut greens, mut others) = (0.0, 0.0, 0.0, 0.0);
        for y in 1..height - 1 {
            // Lines of another frame are no neighbours.
            let stride = self.matrix.starts[y + 1] - self.matrix.starts[y];
            if stride != self.matrix.starts[y] - self.matrix.starts[y - 1] {
                continue;
            }
            for x in 1..width - 1 {
                let at = |dx: usize, dy: usize| f64::from(self.matrix.line(y + dy - 1)[x + dx - 1]);
                let around = (at(0, 0) + at(2, 0) + at(0, 2) + at(2, 2)) / 4.0;
                let differs = (at(1, 1) - around).abs();
                let row = self.row_of(y);
                if is_green(order, x, row) {
                    (green, greens) = (green + differs, greens + 1.0);
                } else {
                    (other, others) = (other + differs, others + 1.0);
                }
            }
        }
        let (green, other) = (green / f64::max(greens, 1.0), other / f64::max(others, 1.0));
        (green > 1.12 * other && green > 1.5).then(|| {
            let candidates: Vec<&str> = BayerOrder::ALL
                .into_iter()
                .filter(|candidate| is_green(*candidate, 0, 0) != is_green(order, 0, 0))
                .map(Choice::name)
                .collect();
            let text = format!(
                "where {} has green, a sample differs from its diagonal neighbours by {green:.1} levels, elsewhere by {other:.1}",
                Choice::name(order)
            );
            let evidence = Evidence::new(text).with("levels_green", green).with("levels_other", other);
            let remedy = self.remedy(FaultKind::BayerPhase).profile(format!("frame.bayer = \"{}\" (or \"{}\": red and blue say which)", candidates[0], candidates[1]));
            let confidence = 0.6 + 0.35 * ((green / other - 1.12) * 3.0).min(1.0);
            found(FaultKind::BayerPhase, confidence, self.at, evidence, remedy)
        })
    }

    /// The frame's row of a line of the matrix: frames follow one another whole.
    fn row_of(&self, y: usize) -> usize {
        y % self.profile.frame.height.max(1) as usize
    }
}

fn is_green(order: BayerOrder, x: usize, y: usize) -> bool {
    order.channel(x, y) as usize == 1
}
