"""Receives the frames that a camif device sends over a serial line.

    import camif_inspect

    for frame in camif_inspect.open("/dev/ttyACM0"):
        print(frame.sequence, frame.verdict, frame.missing_lines)
        picture = frame.pixels  # a numpy array

The map, in data-flow order:

| module | what lives there |
|---|---|
| `port` | where bytes come from: a port by its pyserial URL, or a recording |
| `packet` | packets of the link: framing, CRC, fields |
| `encodings` | the encodings of a line, undone by numpy, a batch at a time |
| `walk`, `qoi` | payloads taken apart, all lines of a batch together; QOI of colour and of samples |
| `frame` | a frame: pixels in their places, what is missing, the device's verdict |
| `stream` | a stream: what is known of it, its frames, how they are numbered |
| `receiver` | bytes become frames, log and statistics; pure |
| `counts` | what a receiver has seen, in numbers |
| `formats` | what the bytes of a pixel mean, and how they look |
| `session` | a thread that listens, and ports that vanish and come back |
| `exchange` | commands sent, again if need be, and their replies found |
| `commands` | commands packed, replies unpacked |
| `registers` | the register map with the names of its bits |
| `recording` | the bytes of the line in a file, with their times |
| `files` | files that are whole or not there |
| `save` | frames as PNG and raw files |
| `view` | the live view: a page in the browser over a websocket |
| `arguments`, `command_line` | the command `camif-inspect` |
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from .commands import Command, Parameter
from .counts import Counts
from .errors import CommandError, FormatError, InspectError, PortError, RecordingError, RequestError
from .frame import Frame
from .packet import Verdict
from .port import DEFAULT_BAUD, source_for
from .session import Session

__all__ = [
    "Command",
    "CommandError",
    "Counts",
    "Device",
    "FormatError",
    "Frame",
    "InspectError",
    "Parameter",
    "PortError",
    "RecordingError",
    "RequestError",
    "Session",
    "Verdict",
    "open",
]
__version__ = "0.1.0"


class Device(Session):
    """A session that is its own sequence of frames."""

    def __iter__(self) -> Iterator[Frame]:
        """Give frames of all streams as they end; see `Session.frames`."""
        return self.frames()

    def __enter__(self) -> Device:
        """Give the device."""
        return self


def open(url: str | Path, *, baud: int = DEFAULT_BAUD, wait: bool = False, speed: float | None = None) -> Device:
    """Open a device, or a recording, by its URL.

    Args:
        url: a port's path, `socket://HOST:PORT` or any other URL that pyserial takes, or the path of a recording.
        baud: rate of a serial line.
        wait: wait for a port that is not there yet rather than raise `PortError`.
        speed: of a recording: 1 as it was recorded, 0 (the default) as fast as frames are taken.
    """
    return Device(source_for(url, baud, speed), wait)
