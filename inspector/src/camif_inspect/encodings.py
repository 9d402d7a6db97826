"""The encodings of a line's pixels, undone.

A receiver sees many lines of one encoding after the other, so a whole batch of payloads is decoded at once: numpy finds
the operations of all of them (see `walk`), and expands all of them, without a loop over bytes.

Every decoder gives the pixels' bytes of all payloads, one after the other, and how many bytes each payload gave.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from . import qoi
from .formats import GRAY8, RAW8, RGB888, PixelFormat
from .packet import Malformed
from .walk import ROOM, Bytes, Counts, evenly, lengths_of, walk

RAW = 0
RUN_LENGTH = 1
QOI = 2
BITS = 3
BITS_RUN_LENGTH = 4
SENDER_CHOOSES = 15

NAMES = {
    RAW: "raw",
    RUN_LENGTH: "run-length",
    QOI: "qoi",
    BITS: "bits",
    BITS_RUN_LENGTH: "bits-run-length",
    SENDER_CHOOSES: "sender chooses",
}


def decode(encoding: int, unused: int, payloads: Sequence[bytes], pixel_format: PixelFormat) -> tuple[Bytes, Counts]:
    """Decode payloads that share encoding, unused bits and format.

    Raises `Malformed` if any of them is; `decode` it alone to find which.
    """
    if encoding == RAW:
        return _raw(payloads, pixel_format)
    if encoding == RUN_LENGTH:
        return evenly(lambda some: run_length(some, pixel_format.unit_bytes), payloads)
    if encoding == QOI and pixel_format.code == RGB888:
        return evenly(qoi.colour, payloads)
    if encoding == QOI and pixel_format.code in (GRAY8, RAW8):
        return evenly(lambda some: qoi.samples(some, 1 if pixel_format.code == GRAY8 else 2), payloads)
    if encoding == BITS and pixel_format.code == GRAY8:
        return _bits(payloads, unused)
    if encoding == BITS_RUN_LENGTH and pixel_format.code == GRAY8:
        return evenly(_bits_run_length, payloads)
    raise Malformed(f"encoding {NAMES.get(encoding, encoding)} of {pixel_format.name}")


def _raw(payloads: Sequence[bytes], pixel_format: PixelFormat) -> tuple[Bytes, Counts]:
    counts = lengths_of(payloads)
    if np.any(counts % pixel_format.unit_bytes):
        raise Malformed("raw pixels that end within a unit")
    return np.frombuffer(b"".join(payloads), np.uint8), counts


def _bits(payloads: Sequence[bytes], unused: int) -> tuple[Bytes, Counts]:
    lengths = lengths_of(payloads)
    if unused and np.any(lengths == 0):
        raise Malformed("more unused bits than bits")
    return _unpacked(np.frombuffer(b"".join(payloads), np.uint8), lengths, lengths * 8 - unused)


def _unpacked(packed: Bytes, lengths: Counts, pixels: Counts) -> tuple[Bytes, Counts]:
    """Make bytes 0 and 255 of bits, the least significant first; each line leaves the last bits of its bytes unused."""
    out = _eight_pixels()[packed].view(np.uint8)
    if np.any(pixels != 8 * lengths):
        place = np.arange(out.size) - np.repeat(8 * (np.cumsum(lengths) - lengths), 8 * lengths)
        out = out[np.flatnonzero(place < np.repeat(pixels, 8 * lengths))]
    return out, pixels


@lru_cache(maxsize=1)
def _eight_pixels() -> npt.NDArray[np.uint64]:
    bits = np.unpackbits(np.arange(256, dtype=np.uint8)[:, None], axis=1, bitorder="little")
    return (bits * np.uint8(255)).view(np.uint64).reshape(-1)


def run_length(payloads: Sequence[bytes], unit: int) -> tuple[Bytes, Counts]:
    """Undo `run-length` over units of `unit` bytes: controls below 128 precede literals, the others a repeated unit."""
    found = walk(payloads, _run_length_lengths(unit))
    places, operations = found.in_order()
    control = found.data[places]
    units = np.where(control < 128, control + np.int32(1), control - np.int32(126))
    until = np.concatenate((np.zeros(1, np.int64), np.cumsum(units, dtype=np.int64)))
    counts = np.diff(until[np.cumsum(operations)], prepend=0)

    # Without controls, and the bytes between payloads, units are left: each once, but for the repeated ones.
    keep = np.ones(found.data.size, bool)
    keep[places] = False
    keep[found.ends] = False
    keep[-ROOM:] = False
    left = found.data[np.flatnonzero(keep)].reshape(-1, unit)
    runs = np.flatnonzero(control >= 128)
    if runs.size:
        line = np.repeat(np.arange(operations.size), operations)
        times = np.ones(left.shape[0], np.int64)
        times[(places[runs] - runs - line[runs]) // unit] = units[runs]
        left = _repeated(left, times)
    return left.reshape(-1), counts * unit


def _repeated(units: Bytes, times: Counts) -> Bytes:
    """Repeat rows of bytes; as numbers, where a row can be one, it is much faster."""
    if units.shape[1] == 3:
        return units.repeat(times, axis=0)
    return units.view(f"u{units.shape[1]}").reshape(-1).repeat(times).view(np.uint8)


@lru_cache
def _run_length_lengths(unit: int) -> npt.NDArray[np.int32]:
    control = np.arange(256)
    return (1 + unit * np.where(control < 128, control + 1, 1)).astype(np.int32)


def _bits_run_length(payloads: Sequence[bytes]) -> tuple[Bytes, Counts]:
    if any(len(payload) < 2 for payload in payloads):
        raise Malformed("a payload without its number of pixels")
    pixels = np.array([payload[0] | payload[1] << 8 for payload in payloads], np.int64)
    packed, lengths = run_length([payload[2:] for payload in payloads], 1)
    if np.any(lengths != (pixels + 7) // 8):
        raise Malformed("a payload of another length than its number of pixels")
    return _unpacked(packed, lengths, pixels)
