//! Where data moves in an analyser's samples, against the edge at which the profile samples.
//!
//! ```text
//! PCLK  ____────____────____      the profile samples at the rising edge, and there the wires move
//! data  ────XX──────XX──────
//! ```
//!
//! Whoever reads such a capture takes the other edge, so the pixel clocks are right; a device does not.

use firmware::camif::pins::Edge;

use super::finding::{Diagnosis, Evidence, Place};
use super::remedy;
use super::structure::{At, found};
use crate::fault::FaultKind;
use crate::profile::{Choice, Profile};
use crate::trace::clock::Clock;

impl Diagnosis {
    /// Adds what a capture's recovered clock says of the profile's edge; nothing if data is still there.
    pub fn look_at_edge(&mut self, clock: &Clock, profile: &Profile) {
        let Some(stillness) = clock.stillness.filter(|_| clock.edge != profile.bus.clock_edge) else {
            return;
        };
        let moving = match profile.bus.clock_edge {
            Edge::Rising => 1.0 - stillness.near_falling,
            Edge::Falling => stillness.near_falling,
        };
        let text = format!(
            "{:.1} % of {} changes of the wires are near the {} edge, at which the profile samples",
            100.0 * moving,
            stillness.changes,
            profile.bus.clock_edge.name()
        );
        let evidence =
            Evidence::new(text).with("changes", stillness.changes as f64).with("share_near_edge", moving);
        let kind = FaultKind::WrongEdge;
        self.findings.retain(|finding| finding.fault != kind);
        self.findings.insert(0, found(kind, 0.95, At::default(), evidence, remedy::of(kind, profile)));
        self.place = Place::WireOrSensor;
    }
}
