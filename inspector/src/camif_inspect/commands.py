"""Commands to the device, and its replies, as the protocol's page has them."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from enum import IntEnum

from . import encodings
from .errors import CommandError, RequestError
from .packet import Reply


class Command(IntEnum):
    """What a device can be asked to do."""

    PING = 0
    HELLO = 1
    START = 2
    STOP = 3
    SNAPSHOT = 4
    STREAMS = 5
    ENCODING = 6
    STAGES = 7
    SET = 8
    GET = 9
    READ = 10
    WRITE = 11
    RESEND = 12
    HEARTBEAT = 13


_STATUSES = {
    1: "does not know the command",
    2: "finds the arguments too short, too long or no UTF-8",
    3: "finds an argument out of range",
    4: "can't do it",
    5: "can't do it now",
    6: "has no such stream",
    7: "has no such register",
    8: "no longer holds the lines",
    9: "tried and failed",
}


def status_text(reply: Reply) -> str:
    """Say what a reply other than 0 means, in the device's words where it gave any."""
    meaning = _STATUSES.get(reply.status, f"answers with status {reply.status}")
    words = reply.rest.decode(errors="replace").strip()
    return f"the device {meaning}: {words}" if words else f"the device {meaning}"


@dataclass(frozen=True)
class Parameter:
    """A parameter of the device: its value, the least and the greatest, and its name with the unit."""

    number: int
    value: int
    least: int
    greatest: int
    name: str


_READ = struct.Struct("<BBxxI")
_WRITE = struct.Struct("<BxxxII")
_RESEND = struct.Struct("<BxHIH")
# The protocol lets one READ take no more.
MOST_REGISTERS = 64


def number(text: str, name: str, least: int, greatest: int) -> int:
    """Read a number, decimal or 0x…, within bounds."""
    try:
        value = int(text, 0)
    except ValueError:
        raise RequestError(f"{name} is a number, such as 12 or 0x0C, not `{text}`") from None
    if not least <= value <= greatest:
        raise RequestError(f"{name} is {least} to {greatest}, not {value}")
    return value


def encoding_code(text: str) -> int:
    """Read an encoding by its name or number; `auto` lets the sender choose."""
    if text in ("auto", "any"):
        return encodings.SENDER_CHOOSES
    for code, name in encodings.NAMES.items():
        if text == name:
            return code
    if text.isdigit():
        return number(text, "an encoding", 0, 15)
    names = ", ".join(name for name in encodings.NAMES.values() if " " not in name)
    raise RequestError(f"`{text}` is no encoding; there are {names} and auto")


def read_arguments(block: int, offset: int, count: int) -> bytes:
    """Pack READ: `count` registers of a block from an offset on."""
    return _READ.pack(block, count, offset)


def read_results(reply: Reply) -> list[int]:
    """Unpack READ's registers."""
    words = reply.rest[_READ.size :]
    return [word for (word,) in struct.iter_unpack("<I", words[: len(words) // 4 * 4])]


def write_arguments(block: int, offset: int, value: int) -> bytes:
    """Pack WRITE."""
    return _WRITE.pack(block, offset, value)


def resend_arguments(stream: int, first: int, sequence: int, count: int) -> bytes:
    """Pack RESEND: `count` lines of a frame from `first` on."""
    return _RESEND.pack(stream, first, sequence, count)


def stages_arguments(stream: int, pipeline: str) -> bytes:
    """Pack STAGES."""
    return struct.pack("<Bxxx", stream) + pipeline.encode()


def set_arguments(parameter: int, value: int) -> bytes:
    """Pack SET."""
    return struct.pack("<Hxxi", parameter, value)


def parameter_of(reply: Reply) -> Parameter:
    """Unpack what SET and GET give."""
    layout = struct.Struct("<Hxxiii")
    if len(reply.rest) < layout.size:
        raise CommandError("the device's answer is shorter than a parameter")
    number, value, least, greatest = layout.unpack_from(reply.rest)
    return Parameter(number, value, least, greatest, reply.rest[layout.size :].decode(errors="replace"))
