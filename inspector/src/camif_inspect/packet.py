"""Packets of the serial link, version 1, as `docs/link-protocol.md` specifies them.

A packet's body is checked once, by `body_of` (framing, CRC) and `parse` (version, length, ranges); from there on it is
a plain object whose fields can be believed.
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from enum import IntEnum

from cobs import cobs

VERSION = 1
LEAST_BODY = 8
LARGEST_BODY = 4096
LARGEST_WIRE = LARGEST_BODY + 17
"""Bytes of the largest packet between two delimiters."""
LARGEST_COMMAND = 512
COMMAND_HEAD = 12
"""Bytes of a command's body besides its arguments."""
DELIMITER = b"\0"
# The CRC-32 of anything followed by its own CRC-32, little-endian.
CRC_RESIDUE = 0x2144DF1C


class Kind(IntEnum):
    """What a packet is; bit 7 is set on the way to the device."""

    HELLO = 0x01
    STREAM = 0x02
    PALETTE = 0x03
    FRAME = 0x04
    LINE = 0x05
    END = 0x06
    HEARTBEAT = 0x07
    LOG = 0x08
    REPLY = 0x09
    COMMAND = 0x81


class Verdict(IntEnum):
    """The device's word on a capture."""

    GOOD = 0
    SHORT = 1
    LONG = 2
    WRONG_LINES = 3
    UNEVEN_LINES = 4
    LINES_DROPPED = 5
    OVERRUN = 6
    SYNC_ERROR = 7
    DMA_ERROR = 8
    DMA_STALLED = 9
    TOO_LATE = 10
    NOT_KNOWN = 255


_VERDICTS = {
    0: "good",
    1: "short",
    2: "long",
    3: "wrong number of lines",
    4: "uneven lines",
    5: "lines dropped for want of a buffer",
    6: "overrun",
    7: "synchronisation code out of order",
    8: "DMA error",
    9: "DMA stalled",
    10: "interrupt served too late",
    255: "not known",
}
_CAUSES = {
    0: "none",
    1: "no clock",
    2: "no VSYNC",
    3: "no data",
    4: "short frame",
    5: "DMA stalled",
    6: "overrun",
    7: "damaged",
    8: "unfinished",
    9: "no buffer",
    10: "stopped",
    11: "refused",
    255: "another",
}
_LEVELS = {1: "error", 2: "warning", 3: "information", 4: "debug", 5: "trace"}
_STATES = {0: "stopped", 1: "running", 2: "snapshot"}


def verdict_name(code: int) -> str:
    """Name a verdict; one that this version does not know by its number."""
    return _VERDICTS.get(code, f"verdict {code}")


class Damaged(Exception):  # noqa: N818 (what came, not what went wrong here)
    """Bytes between two delimiters that are no packet."""


class Malformed(Exception):  # noqa: N818
    """A packet whose CRC is right and whose content is not."""


@dataclass(frozen=True)
class Hello:
    """Who the device is and what it can do."""

    oldest_version: int
    newest_version: int
    largest_received: int
    largest_sent: int
    streams: int
    commands: int
    encodings: int
    session: int
    name: str


@dataclass(frozen=True)
class StreamInfo:
    """What a stream carries."""

    stream: int
    format: int
    encoding: int
    on: bool
    width: int
    height: int
    meaning: int
    pipeline: str
    name: str


@dataclass(frozen=True)
class Palette:
    """The colours of an indexed stream: red, green, blue of index 0, 1, …."""

    stream: int
    colors: bytes

    @property
    def crc(self) -> int:
        """The CRC-32 by which a FRAME names it."""
        return zlib.crc32(self.colors)


@dataclass(frozen=True)
class FrameStart:
    """A frame begins."""

    stream: int
    format: int
    meaning: int
    snapshot: bool
    sequence: int
    width: int
    height: int
    captured_at: int
    palette_crc: int


@dataclass(frozen=True)
class Line:
    """A line, or a piece of one, still encoded. `sequence` has the low 16 bits only."""

    stream: int
    format: int
    encoding: int
    unused: int
    again: bool
    sequence: int
    line: int
    first: int
    payload: bytes


@dataclass(frozen=True)
class FrameEnd:
    """A frame is over."""

    stream: int
    format: int
    verdict: int
    sequence: int
    width: int
    height: int
    lines_captured: int
    bytes_captured: int
    min_line_bytes: int
    max_line_bytes: int
    detail: int
    overruns: int
    dropped: int
    bytes_sent: int
    frame_crc: int
    lines_sent: int


@dataclass(frozen=True)
class Heartbeat:
    """The device is alive. Counters are since its start and wrap at 2³²; `uptime` is in microseconds."""

    session: int
    uptime: int
    delivered: int
    dropped: int
    lost: int
    skipped: int
    overruns: int
    sync_errors: int
    dma_errors: int
    lines_dropped: int
    packets_sent: int
    bytes_sent: int
    packets_unsent: int
    packets_received: int
    packets_damaged: int
    baud: int
    state: int
    cause: int

    @property
    def state_name(self) -> str:
        """Name the state of the capture."""
        return _STATES.get(self.state, f"state {self.state}")

    @property
    def cause_name(self) -> str:
        """Name what the camera's last time-out came from."""
        return _CAUSES.get(self.cause, f"cause {self.cause}")


@dataclass(frozen=True)
class Log:
    """A line of the device's log. `time` is in microseconds since its start."""

    level: int
    cut: bool
    lost: int
    time: int
    text: str

    @property
    def level_name(self) -> str:
        """Name the level."""
        return _LEVELS.get(self.level, f"level {self.level}")


@dataclass(frozen=True)
class Reply:
    """The answer to a command."""

    request: int
    command: int
    status: int
    rest: bytes


@dataclass(frozen=True)
class OtherVersion:
    """A packet of a protocol version that this program does not speak, and of a HELLO the device's own words."""

    version: int
    oldest_version: int | None = None
    newest_version: int | None = None


@dataclass(frozen=True)
class UnknownKind:
    """A packet of a kind that is not known here, or not for this end."""

    kind: int


Packet = (
    Hello | StreamInfo | Palette | FrameStart | Line | FrameEnd | Heartbeat | Log | Reply | OtherVersion | UnknownKind
)

_HELLO = struct.Struct("<4s2B2HBxIHxxI")
_STREAM = struct.Struct("<4B2H2Bxx")
_PALETTE = struct.Struct("<BxH")
_FRAME = struct.Struct("<4BI2HQI")
_LINE = struct.Struct("<4B3H")
_END = struct.Struct("<3BxI2H9IHxx")
_HEARTBEAT = struct.Struct("<IQ14I2Bxx")
_LOG = struct.Struct("<2BHQ")
_REPLY = struct.Struct("<H2B")
_COMMAND = struct.Struct("<HBx")


def body_of(wire: bytes) -> bytes:
    """Take the body out of what stood between two delimiters, and check its CRC; the CRC stays on it."""
    if len(wire) > LARGEST_WIRE:
        raise Damaged("longer than the longest packet")
    try:
        body: bytes = cobs.decode(wire)
    except cobs.DecodeError as error:
        raise Damaged(str(error)) from None
    if not LEAST_BODY <= len(body) <= LARGEST_BODY:
        raise Damaged("too short or too long")
    if zlib.crc32(body) != CRC_RESIDUE:
        raise Damaged("wrong CRC")
    return body


def wire_of(content: bytes, kind: Kind, version: int = VERSION) -> bytes:
    """Frame what follows a body's first four bytes: head, CRC, stuffing, and the delimiter at the end."""
    body = struct.pack("<2BH", version, kind, len(content)) + content
    return bytes(cobs.encode(body + struct.pack("<I", zlib.crc32(body)))) + DELIMITER


def command_wire(request: int, command: int, arguments: bytes = b"") -> bytes:
    """Frame a command."""
    return wire_of(_COMMAND.pack(request, command) + arguments, Kind.COMMAND)


def _text(data: bytes) -> str:
    try:
        return data.decode()
    except UnicodeDecodeError:
        raise Malformed("text that is no UTF-8") from None


def _hello(content: bytes) -> Hello:
    magic, oldest, newest, received, sent, streams, commands, encodings, session = _HELLO.unpack_from(content)
    if magic != b"CAMI":
        raise Malformed("a HELLO without CAMI")
    return Hello(oldest, newest, received, sent, streams, commands, encodings, session, _text(content[_HELLO.size :]))


def _stream(content: bytes) -> StreamInfo:
    stream, pixel_format, encoding, flags, width, height, meaning, length = _STREAM.unpack_from(content)
    text = content[_STREAM.size :]
    if length > len(text):
        raise Malformed("a pipeline longer than the packet")
    pipeline, name = _text(text[:length]), _text(text[length:])
    return StreamInfo(stream, pixel_format, encoding, bool(flags & 1), width, height, meaning, pipeline, name)


def _palette(content: bytes) -> Palette:
    stream, count = _PALETTE.unpack_from(content)
    colors = content[_PALETTE.size :]
    if not 1 <= count <= 256 or len(colors) != 3 * count:
        raise Malformed("a palette of another length than it says")
    return Palette(stream, colors)


def _frame(content: bytes) -> FrameStart:
    stream, pixel_format, meaning, flags, *rest = _FRAME.unpack_from(content)
    return FrameStart(stream, pixel_format, meaning, bool(flags & 1), *rest)


def _line(content: bytes) -> Line:
    stream, pixel_format, bits, flags, sequence, line, first = _LINE.unpack_from(content)
    encoding, unused = bits & 0x0F, bits >> 4 & 0x07
    payload = content[_LINE.size :]
    if unused and not payload:
        raise Malformed("more unused bits than bits")
    return Line(stream, pixel_format, encoding, unused, bool(flags & 1), sequence, line, first, payload)


def _log(content: bytes) -> Log:
    level, flags, lost, time = _LOG.unpack_from(content)
    return Log(level, bool(flags & 1), lost, time, _text(content[_LOG.size :]))


def _reply(content: bytes) -> Reply:
    request, command, status = _REPLY.unpack_from(content)
    return Reply(request, command, status, content[_REPLY.size :])


_PARSERS = {
    Kind.HELLO: (_HELLO.size, _hello),
    Kind.STREAM: (_STREAM.size, _stream),
    Kind.PALETTE: (_PALETTE.size, _palette),
    Kind.FRAME: (_FRAME.size, _frame),
    Kind.LINE: (_LINE.size, _line),
    Kind.END: (_END.size, lambda content: FrameEnd(*_END.unpack_from(content))),
    Kind.HEARTBEAT: (_HEARTBEAT.size, lambda content: Heartbeat(*_HEARTBEAT.unpack_from(content))),
    Kind.LOG: (_LOG.size, _log),
    Kind.REPLY: (_REPLY.size, _reply),
}


def parse(body: bytes) -> Packet:
    """Read a body that `body_of` gave. Raises `Malformed`."""
    if body[0] != VERSION:
        # The first 16 bytes of a HELLO are the same in all versions.
        if body[1] == Kind.HELLO and len(body) >= 20 and body[4:8] == b"CAMI":
            return OtherVersion(body[0], body[8], body[9])
        return OtherVersion(body[0])
    if int.from_bytes(body[2:4], "little") != len(body) - LEAST_BODY:
        raise Malformed("the length is not that of the body")
    parser = _PARSERS.get(body[1])  # type: ignore[call-overload]
    if parser is None:
        return UnknownKind(body[1])
    least, parse_content = parser
    content = body[4:-4]
    if len(content) < least:
        raise Malformed("shorter than its kind")
    packet: Packet = parse_content(content)
    return packet
