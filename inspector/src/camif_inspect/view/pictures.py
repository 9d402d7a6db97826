"""Which rows of which frame a page needs next, and how they are packed.

A page is sent rows, not frames: over a slow line it sees a frame arrive line by line; over a fast one it gets whole
frames, the newest first, and skips what it has no time for.

A message is, little-endian: a 32-bit length and that many bytes of JSON (padded with spaces to a multiple of four); a
byte for each line of the frame, 1 where it is there; the rows as a screen shows them, one or three bytes a pixel; and,
where they are other numbers, the values of the rows' pixels, 8 or 16 bits each.
"""

from __future__ import annotations

import json
import struct
import time
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from ..formats import to_rgb, values
from ..frame import Frame
from ..stream import Stream

# A frame that takes longer than this to come is shown while it comes.
_PATIENCE_SECONDS = 0.25


@dataclass
class _Shown:
    """What a page has of a stream: which frame, how far, and in which state."""

    frame: Frame | None = None
    reached: npt.NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    changes: int = -1


@dataclass
class _Rows:
    """Rows taken out of a frame while the receiver stood still."""

    frame: Frame
    first: int
    data: npt.NDArray[np.uint8]
    present: npt.NDArray[np.bool_]
    head: dict[str, object]


class Pictures:
    """What one page has seen, and what it lacks."""

    def __init__(self) -> None:
        """Start with a page that has seen nothing."""
        self._shown: dict[int, _Shown] = {}
        self._opened: dict[int, tuple[Frame, float]] = {}
        self.frames: dict[int, Frame] = {}

    def lacking(self, streams: dict[int, Stream]) -> list[_Rows]:
        """Take the rows that the page lacks; the receiver must be locked meanwhile."""
        rows = []
        for number, stream in streams.items():
            frame = self._choose(number, stream)
            if frame is None:
                continue
            shown = self._shown.setdefault(number, _Shown())
            if shown.frame is frame and shown.changes == frame.changes:
                continue
            rows.append(self._take(frame, shown))
            self.frames[number] = frame
        return rows

    def _choose(self, number: int, stream: Stream) -> Frame | None:
        """Give the frame to show: the last whole one, unless the one that arrives is slow."""
        shown = self._shown.get(number)
        last = stream.kept[-1] if stream.kept else None
        arriving = stream.open
        if arriving is None:
            return last
        since = self._opened.get(number)
        if since is None or since[0] is not arriving:
            since = self._opened[number] = (arriving, time.monotonic())
        if shown is not None and shown.frame is arriving:
            return arriving
        last_is_shown = last is None or (shown is not None and shown.frame is last and shown.changes == last.changes)
        if last_is_shown and time.monotonic() - since[1] > _PATIENCE_SECONDS and arriving.reached.any():
            return arriving
        return last

    @staticmethod
    def _take(frame: Frame, shown: _Shown) -> _Rows:
        reached = frame.reached
        if shown.frame is frame and shown.reached.size == reached.size:
            new = np.flatnonzero(reached != shown.reached)
        else:
            new = np.flatnonzero(reached)
        if frame.format.bayer and new.size:
            # A pixel's colours come from the lines around it.
            new = np.array([0, frame.height - 1])
        first, after = (int(new[0]), int(new[-1]) + 1) if new.size else (0, 0)
        if frame.closed and frame.palette is not None and shown.changes != frame.changes:
            first, after = 0, frame.height
        shown.frame, shown.reached, shown.changes = frame, reached.copy(), frame.changes
        missing = int(np.count_nonzero(frame.missing))
        head: dict[str, object] = {
            "type": "picture",
            "stream": frame.stream,
            "name": frame.name or f"stream {frame.stream}",
            "sequence": frame.sequence,
            "width": frame.width,
            "height": frame.height,
            "format": frame.format.name,
            "channels": frame.format.channels,
            "bits": frame.format.bits,
            "first": first,
            "rows": after - first,
            "closed": frame.closed,
            "verdict": frame.verdict_text,
            "good": frame.end is not None and frame.end.verdict == 0,
            "whole": frame.whole,
            "crc_ok": frame.crc_ok,
            "missing": missing,
            "captured_at": frame.captured_at,
        }
        return _Rows(frame, first, frame.data[first:after].copy(), frame.present.copy(), head)


def packed(rows: _Rows) -> bytes:
    """Pack rows into a message for the page."""
    frame = rows.frame
    display = to_rgb(rows.data, frame.format, frame.width, frame.meaning, frame.palette)
    numbers = values(rows.data, frame.format, frame.width)
    separate = numbers.shape != display.shape or numbers.dtype != display.dtype or len(frame.format.channels) > 1
    separate = separate and frame.format.channels != ("R", "G", "B")
    head = json.dumps(
        rows.head
        | {
            "display": 3 if display.ndim == 3 else 1,
            "values": numbers.dtype.itemsize if separate else 0,
        }
    ).encode()
    head += b" " * (-len(head) % 4)
    parts = [struct.pack("<I", len(head)), head, rows.present.tobytes(), np.ascontiguousarray(display).tobytes()]
    if separate:
        # 16-bit numbers begin at an even place.
        parts.append(b"\0" * (sum(map(len, parts)) % 2))
        parts.append(np.ascontiguousarray(numbers).astype(numbers.dtype.newbyteorder("<")).tobytes())
    return b"".join(parts)
