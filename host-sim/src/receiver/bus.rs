use firmware::camif::{Bus, Stall};

/// Why a `--bus-latency` could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{part}` is no bus latency; write MIN or MIN..MAX pixel clocks, and after commas stall=CLOCKS/ONE_IN or seed=N, \
     for instance 0..3,stall=40/1000,seed=7"
)]
pub struct BusSyntaxError {
    /// The part that could not be read.
    pub part: String,
}

/// Reads the memory bus from text: `MIN`, or `MIN..MAX` pixel clocks from request to grant, then `stall=CLOCKS/ONE_IN`
/// (one request in `ONE_IN` waits so much longer) and `seed=N`.
///
/// # Errors
/// [`BusSyntaxError`] with the part that is wrong.
pub fn parse_bus(text: &str) -> Result<Bus, BusSyntaxError> {
    let mut bus = Bus::IDEAL;
    for part in text.split(',') {
        let wrong = || BusSyntaxError { part: part.to_owned() };
        let number = |text: &str| text.trim().parse::<u32>().map_err(|_| wrong());
        if let Some(stall) = part.strip_prefix("stall=") {
            let (clocks, one_in) = stall.split_once('/').ok_or_else(wrong)?;
            bus.stall = Some(Stall { clocks: number(clocks)?, one_in: number(one_in)? });
        } else if let Some(seed) = part.strip_prefix("seed=") {
            bus.seed = seed.trim().parse().map_err(|_| wrong())?;
        } else {
            let (min, max) = part.split_once("..").unwrap_or((part, part));
            (bus.latency_min, bus.latency_max) = (number(min)?, number(max)?);
            if bus.latency_min > bus.latency_max {
                return Err(wrong());
            }
        }
    }
    Ok(bus)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bus_is_read() {
        let bus = parse_bus("0..3,stall=40/1000,seed=7").unwrap();
        let stall = Some(Stall { one_in: 1000, clocks: 40 });
        assert_eq!(bus, Bus { latency_max: 3, stall, seed: 7, ..Bus::IDEAL });
        assert_eq!(parse_bus("5").unwrap(), Bus { latency_min: 5, latency_max: 5, ..Bus::IDEAL });
    }

    #[test]
    fn what_is_no_bus_is_quoted() {
        for (text, part) in
            [("", ""), ("x", "x"), ("3..1", "3..1"), ("1,stall=4", "stall=4"), ("1,seed=-1", "seed=-1")]
        {
            assert_eq!(parse_bus(text), Err(BusSyntaxError { part: part.to_owned() }));
        }
    }
}
