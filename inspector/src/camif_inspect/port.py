"""Where bytes come from: a port by its pyserial URL, or a recording.

A source is opened, read in pieces with their times, written to, and closed; when it vanishes `read` says so with a
`PortError`, and it can be opened again. Waiting and trying again is the session's business.
"""

from __future__ import annotations

import errno
import os
import select
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple, Protocol
from urllib.parse import urlsplit

import serial

from .errors import InspectError, PortError
from .recording import FROM_DEVICE, Record, RecordingReader, is_recording

DEFAULT_BAUD = 921_600
# How long a read waits for more bytes: short beside what an eye notices, long beside a system call.
_POLL_SECONDS = 0.02
# A read takes all that has come meanwhile: the more, the better lines are decoded together.
_READ_BYTES = 1 << 20
# A device that stops reading must not hang the one who sends it a command.
_WRITE_SECONDS = 2.0


class Chunk(NamedTuple):
    """Bytes that came together.

    Attributes:
        time: when they came, in seconds on the source's own clock.
        data: the bytes.
        caught_up: whether nothing waited when the read began: whatever had reached this end by then, has been read.
    """

    time: float
    data: bytes
    caught_up: bool = True


class EndOfSource(Exception):  # noqa: N818 (an end is no error)
    """A recording is at its end.

    Attributes:
        cut_short: whether that is within a record.
    """

    def __init__(self, name: str, cut_short: bool) -> None:
        """Name the recording, and say how it ends."""
        super().__init__(f"{name} is at its end" + (", cut short within a record" if cut_short else ""))
        self.cut_short = cut_short


class Source(Protocol):
    """What a session reads from."""

    name: str
    live: bool

    def open(self) -> None:
        """Open it, or raise `PortError`; another `InspectError` where waiting would be in vain."""

    def read(self) -> Chunk:
        """Wait a moment for bytes; none may have come. Raises `PortError` when it is gone, `EndOfSource` at the end."""

    def write(self, data: bytes) -> None:
        """Send bytes to the device, all of them."""

    def now(self) -> float:
        """Seconds on this source's clock."""

    def close(self) -> None:
        """Close it; harmless when it is closed."""


def _reason(error: BaseException) -> str:
    """Say in a few words why the system refused."""
    if isinstance(error, TypeError):
        # What pyserial makes of a port that another thread closes meanwhile.
        return "it was closed meanwhile"
    text = str(error) or type(error).__name__
    if "exclusively lock" in text:
        return "another program has it open"
    number = getattr(error, "errno", None)
    if isinstance(error, serial.SerialException) and error.__context__ is not None and number is None:
        number = getattr(error.__context__, "errno", None)
    if isinstance(number, int) and number in errno.errorcode:
        return os.strerror(number).lower()
    if "readiness to read but returned no data" in text:
        return "it was unplugged, or its other end closed, or another program reads it as well"
    if "Inappropriate ioctl" in text:
        return "it is no serial port"
    # pyserial prefixes what we say already.
    return text.split(": ", 1)[-1].split("\n", 1)[0]


def _check_address(url: str) -> None:
    """See that a URL of a socket names one, which pyserial says in words of its own program."""
    scheme, _, rest = url.partition("://")
    if scheme.lower() not in ("socket", "rfc2217"):
        return
    try:
        address = urlsplit(f"//{rest}")
        if address.hostname and address.port:
            return
    except ValueError:
        pass
    raise InspectError(f"cannot open {url}: write {scheme}://HOST:PORT, with a port from 1 to 65535")


def _open_as_it_is(port: serial.SerialBase) -> None:
    """Open without the flush that comes with it: what a device has said already, its HELLO for one, is worth having."""
    flushes = ("reset_input_buffer", "_reset_input_buffer")
    for name in flushes:
        setattr(port, name, lambda: None)
    try:
        port.open()
    finally:
        for name in flushes:
            delattr(port, name)


class SerialSource:
    """A port by any URL that pyserial takes: a device's path, a pty, `socket://HOST:PORT`, `rfc2217://`, `loop://`."""

    live = True

    def __init__(self, url: str, baud: int = DEFAULT_BAUD) -> None:
        """Take a note of the URL; nothing is opened yet. `baud` is ignored where there is no line, as on a socket."""
        _check_address(url)
        self.name = url
        self.baud = baud
        self._port: Any = None

    def open(self) -> None:
        """Open the port, 8 data bits, no parity, 1 stop bit, no flow control."""
        self.close()
        try:
            port = serial.serial_for_url(
                self.name,
                do_not_open=True,
                baudrate=self.baud,
                timeout=_POLL_SECONDS,
                write_timeout=_WRITE_SECONDS,
                # Of two programs that read one port, each gets half of every packet.
                exclusive=True,
            )
            _open_as_it_is(port)
            self._port = port
            if not isinstance(self._port, serial.Serial) and hasattr(self._port, "fileno"):
                self._port.timeout = 0
        except (serial.SerialException, OSError) as error:
            raise PortError(f"cannot open {self.name}: {_reason(error)}") from error
        except ValueError as error:
            # A URL or a rate that will not do: nothing to wait for.
            raise InspectError(f"cannot open {self.name}: {_reason(error)}") from error

    def read(self) -> Chunk:
        """Read what has come, at most 1 MiB."""
        if self._port is None:
            raise PortError(f"{self.name} is not open")
        try:
            data, caught_up = self._read()
        except (serial.SerialException, OSError, TypeError) as error:
            # pyserial lets a TypeError out when another thread closes the port meanwhile.
            self.close()
            raise PortError(f"{self.name} is gone: {_reason(error)}") from error
        return Chunk(self.now(), data, caught_up)

    def _read(self) -> tuple[bytes, bool]:
        """Read no more than is there, for pyserial throws away what it has when it finds the other end gone."""
        port = self._port
        if isinstance(port, serial.Serial) or not hasattr(port, "fileno"):
            waiting = port.in_waiting
            return bytes(port.read(max(1, min(waiting, _READ_BYTES)))), not waiting
        # A socket does not tell how much there is, but with no time to wait a read ends after one piece.
        waiting = bool(select.select([port.fileno()], [], [], 0)[0])
        ready = waiting or bool(select.select([port.fileno()], [], [], _POLL_SECONDS)[0])
        return bytes(port.read(_READ_BYTES)) if ready else b"", not waiting

    def write(self, data: bytes) -> None:
        """Send bytes; raises `PortError` when the port is gone or takes none for two seconds."""
        if self._port is None:
            raise PortError(f"{self.name} is not open")
        try:
            self._port.write(data)
        except (serial.SerialException, OSError, TypeError) as error:
            raise PortError(f"cannot send to {self.name}: {_reason(error)}") from error

    def now(self) -> float:
        """Give the monotonic clock."""
        return time.monotonic()

    def close(self) -> None:
        """Close the port."""
        port, self._port = self._port, None
        if port is not None:
            try:
                port.close()
            except (serial.SerialException, OSError):
                # A port that was pulled out has nothing left to close.
                return


class RecordedSource:
    """A recording, played at its own speed, faster, slower, or as fast as it is taken."""

    live = False

    def __init__(self, path: Path, speed: float = 1.0, loop: bool = False) -> None:
        """Open a recording. `speed` is relative to the recorded one, 0 does not wait at all; `loop` starts anew."""
        self.name = str(path)
        self.speed = speed
        self.loop = loop
        self.reader = RecordingReader(path)
        self._records: Iterator[Record] = iter(())
        self._started = 0.0
        self._time = 0.0
        self._round = 0.0
        self._next: Record | None = None

    def open(self) -> None:
        """Start from the first record."""
        self._records = iter(self.reader)
        self._started = time.monotonic()
        self._round = self._time = 0.0
        self._next = None

    def read(self) -> Chunk:
        """Give the next bytes from the device when their time has come."""
        if self._next is None:
            self._next = self._following()
        due = self._round + self._next.time
        if self.speed > 0:
            wait = self._started + due / self.speed - time.monotonic()
            if wait > 0:
                time.sleep(min(wait, _POLL_SECONDS))
            if wait > _POLL_SECONDS:
                self._time = max(self._time, due - (wait - _POLL_SECONDS) * self.speed)
                return Chunk(self._time, b"")
        record, self._next = self._next, None
        self._time = max(self._time, due)
        if self.speed > 0:
            return Chunk(self._time, record.data)
        return self._as_much_as_a_port_gives(record.data)

    def _as_much_as_a_port_gives(self, data: bytes) -> Chunk:
        """Read on: where nothing waits for its time, large pieces are decoded the fastest."""
        parts, length = [data], len(data)
        while length < _READ_BYTES:
            try:
                record = self._following()
            except EndOfSource:
                break
            parts.append(record.data)
            length += len(record.data)
            self._time = max(self._time, self._round + record.time)
        return Chunk(self._time, b"".join(parts))

    def _following(self) -> Record:
        """Take the next record that came from the device."""
        for again in (False, True):
            if again:
                # Half a second of silence stands between two rounds, as between two runs of a device.
                self._round = self._time + 0.5
                self._records = iter(self.reader)
            for record in self._records:
                if record.direction == FROM_DEVICE:
                    return record
            if not self.loop:
                break
        raise EndOfSource(self.name, self.reader.cut_short)

    def write(self, data: bytes) -> None:  # noqa: ARG002 (a recording takes nothing)
        """Refuse: nobody listens."""
        raise PortError(f"{self.name} is a recording; it takes no commands")

    def now(self) -> float:
        """Give the time within the recording."""
        return self._time

    def close(self) -> None:
        """Do nothing; the file stays open for another round."""


def source_for(url: str | Path, baud: int = DEFAULT_BAUD, speed: float | None = None, loop: bool = False) -> Source:
    """Give the source behind a URL: a recording when it names one, a port otherwise.

    `speed` is for recordings: 0, the default, plays as fast as it is taken.
    """
    path = Path(url)
    if is_recording(path):
        return RecordedSource(path, 0.0 if speed is None else speed, loop)
    if path.is_file():
        raise InspectError(f"{path} is a file but no recording; make one with `camif-inspect record`")
    return SerialSource(str(url), baud)
