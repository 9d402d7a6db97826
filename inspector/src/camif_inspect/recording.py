r"""Recordings: the bytes of the line with their times, to replay without a device.

The file, little-endian:

| offset | bytes | what |
|---|---|---|
| 0 | 8 | `CAMIFREC` |
| 8 | 4 | version, 1 |
| 12 | 4 | 0 |
| 16 | 8 | when it started, nanoseconds since 1970 in UTC |

then records up to the end of the file:

| offset | bytes | what |
|---|---|---|
| 0 | 8 | nanoseconds since the start; never less than the record before |
| 8 | 1 | 0: from the device, 1: to the device |
| 9 | 3 | 0 |
| 12 | 4 | length |
| 16 | length | the bytes, as they were on the line |

A record cut short at the end of the file, as a crash leaves it, ends the recording.
"""

from __future__ import annotations

import struct
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from .errors import RecordingError

MAGIC = b"CAMIFREC"
VERSION = 1
SUFFIX = ".camr"

_HEADER = struct.Struct("<8sIIQ")
_RECORD = struct.Struct("<QB3xI")
# No read of a port is longer; a length above it is damage, not a record.
_LONGEST = 1 << 26

FROM_DEVICE = 0
TO_DEVICE = 1


@dataclass(frozen=True)
class Record:
    """Bytes that were on the line at one time.

    Attributes:
        time: seconds since the start of the recording.
        direction: `FROM_DEVICE` or `TO_DEVICE`.
        data: the bytes.
    """

    time: float
    direction: int
    data: bytes


class RecordingWriter:
    """Writes records to an open file; the caller names, closes and renames it.

    Attributes:
        bytes_written: bytes of the line that the file holds.
        failure: why there is no more in it, such as a full disk; None while all is well.
    """

    def __init__(self, file: IO[bytes], started: float | None = None) -> None:
        """Write the header. `started` is in seconds since 1970; now, if it is left out.

        A file that was opened without a buffer holds every whole record, whatever happens afterwards.
        """
        self._file = file
        self._last = 0
        self.bytes_written = 0
        self.failure: OSError | None = None
        seconds = time.time() if started is None else started
        self._put(_HEADER.pack(MAGIC, VERSION, 0, int(seconds * 1e9)))

    def write(self, at: float, data: bytes, direction: int = FROM_DEVICE) -> None:
        """Append bytes that were on the line `at` seconds after the start; nothing any more after a failure."""
        if self.failure is not None:
            return
        self._last = max(self._last, int(at * 1e9))
        try:
            self._put(_RECORD.pack(self._last, direction, len(data)) + data)
        except OSError as error:
            # Whoever listens goes on. What was written of the record, a reader takes for its end.
            self.failure = error
        else:
            self.bytes_written += len(data)

    def _put(self, data: bytes) -> None:
        """Write all of it; a file without a buffer may take some at a time."""
        rest = memoryview(data)
        while rest:
            rest = rest[self._file.write(rest) :]


def is_recording(path: Path) -> bool:
    """Tell whether a path is a regular file that starts as a recording does."""
    try:
        if not path.is_file():
            return False
        with path.open("rb") as file:
            return file.read(len(MAGIC)) == MAGIC
    except OSError:
        return False


class RecordingReader:
    """The records of a file, in order."""

    def __init__(self, path: Path) -> None:
        """Open a recording and check its header."""
        self.path = path
        try:
            self.size = path.stat().st_size
            self._file = path.open("rb")
        except OSError as error:
            raise RecordingError(f"cannot read {path}: {error.strerror}") from error
        header = self._file.read(_HEADER.size)
        if len(header) < _HEADER.size or not header.startswith(MAGIC):
            self._file.close()
            raise RecordingError(
                f"{path} is no recording: it does not start with {MAGIC.decode()}; make one with `record`"
            )
        _, version, _, started = _HEADER.unpack(header)
        if version != VERSION:
            self._file.close()
            raise RecordingError(f"{path} is a recording of version {version}; this program reads version {VERSION}")
        self.started = started / 1e9
        self.cut_short = False

    @property
    def position(self) -> int:
        """Bytes of the file read so far."""
        return self._file.tell()

    def __iter__(self) -> Iterator[Record]:
        """Give the records from the first on; one that the file ends within is none, and is noted in `cut_short`."""
        self._file.seek(_HEADER.size)
        while True:
            header = self._file.read(_RECORD.size)
            if len(header) < _RECORD.size:
                self.cut_short = len(header) > 0
                return
            at, direction, length = _RECORD.unpack(header)
            if length > _LONGEST or direction not in (FROM_DEVICE, TO_DEVICE):
                place = self._file.tell() - _RECORD.size
                raise RecordingError(f"{self.path} is damaged at byte {place}: no record starts there")
            data = self._file.read(length)
            if len(data) < length:
                self.cut_short = True
                return
            yield Record(at / 1e9, direction, data)

    def close(self) -> None:
        """Close the file."""
        self._file.close()
