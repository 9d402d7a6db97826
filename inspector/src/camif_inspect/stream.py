"""A stream of the link: what is known of it, its frames, and how they are numbered."""

from __future__ import annotations

from dataclasses import dataclass, field

from .frame import Frame
from .packet import StreamInfo


@dataclass
class Stream:
    """What is known of a stream, and its frames.

    Attributes:
        number: its number.
        info: what the device said last about it.
        open: the frame that is arriving.
        kept: frames that are over, the latest last.
        frames: frames that are over, counted.
    """

    number: int
    info: StreamInfo | None = None
    open: Frame | None = None
    kept: list[Frame] = field(default_factory=list)
    frames: int = 0
    size: tuple[int, int] | None = None
    meaning: int = 0
    last_sequence: int | None = None

    @property
    def name(self) -> str:
        """The stream's name, or its number."""
        return self.info.name if self.info and self.info.name else f"stream {self.number}"


def is_numbered(frame: Frame, sequence: int) -> bool:
    """Whether a frame, of whose number only the low half may be known, is the one of this number."""
    return frame.sequence == sequence or (not frame.sequence_known and frame.sequence == sequence & 0xFFFF)


def after(sequence: int, last: int) -> int:
    """How far a frame's number is after another, modulo 2³²."""
    return (sequence - last + (1 << 31)) % (1 << 32) - (1 << 31)
