"""What a receiver has seen, in numbers."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class Counts:
    """What has come since the receiver was made.

    Attributes:
        bytes: bytes, delimiters included.
        received: packets that were used.
        damaged: pieces between delimiters that are no packet: CRC errors and the like.
        malformed: packets whose CRC is right and whose content is not.
        other_version: packets of another protocol version.
        unknown_kind: packets of a kind that is not known here.
        fragments: pieces of a packet cut off by the beginning of listening.
        lines: lines, or pieces of them, put in their places.
        unfit: lines that fit nowhere: outside the picture, with a broken payload, or of a frame that is gone.
        frames: frames that are over.
        frames_whole: of these, those without any fault.
        frames_bad_verdict: of these, those with another verdict than good.
        frames_bad_crc: of these, those whose own CRC is wrong: a fault of the device.
        frames_endless: of these, those whose end was lost.
        lines_lost: lines that the link lost.
    """

    bytes: int = 0
    received: int = 0
    damaged: int = 0
    malformed: int = 0
    other_version: int = 0
    unknown_kind: int = 0
    fragments: int = 0
    lines: int = 0
    unfit: int = 0
    frames: int = 0
    frames_whole: int = 0
    frames_bad_verdict: int = 0
    frames_bad_crc: int = 0
    frames_endless: int = 0
    lines_lost: int = 0
