"""Rates out of counters: what came over the line in a stretch of time."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from .receiver import Receiver


@dataclass(frozen=True)
class Sample:
    """Counters at one time, in seconds."""

    time: float
    counts: dict[str, int]
    frames: dict[int, int]


def sample(receiver: Receiver, at: float) -> Sample:
    """Take the counters of a receiver."""
    return Sample(at, asdict(receiver.counts), {number: stream.frames for number, stream in receiver.streams.items()})


@dataclass(frozen=True)
class Rates:
    """What came between two samples.

    Attributes:
        seconds: how long that was.
        bytes: bytes a second.
        frames: frames a second, by stream.
        lines_lost: lines lost.
        damaged: packets damaged: CRC errors and the like.
    """

    seconds: float
    bytes: float
    frames: dict[int, float]
    lines_lost: int
    damaged: int


def between(first: Sample, last: Sample) -> Rates:
    """Give the rates from one sample to a later one; all zero when no time has passed."""
    seconds = last.time - first.time
    if seconds <= 0:
        return Rates(0.0, 0.0, dict.fromkeys(last.frames, 0.0), 0, 0)

    def grown(name: str) -> int:
        return last.counts[name] - first.counts[name]

    frames = {number: (count - first.frames.get(number, 0)) / seconds for number, count in last.frames.items()}
    return Rates(seconds, grown("bytes") / seconds, frames, grown("lines_lost"), grown("damaged"))


def as_json(first: Sample, last: Sample, receiver: Receiver) -> dict[str, Any]:
    """Put the rates, the counts and the device's own statistics into one object."""
    rates = between(first, last)
    beat = receiver.heartbeat
    return {
        "seconds": rates.seconds,
        "bytes_per_second": rates.bytes,
        "streams": [
            {
                "stream": number,
                "name": stream.name,
                "frames": stream.frames,
                "frames_per_second": rates.frames.get(number, 0.0),
            }
            for number, stream in sorted(receiver.streams.items())
        ],
        "counts": asdict(receiver.counts),
        "other_versions": dict(receiver.versions),
        "device": asdict(beat) | {"state": beat.state_name, "cause": beat.cause_name} if beat else None,
    }
