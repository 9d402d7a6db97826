"""The encodings of a line's pixels, undone.

A receiver sees many lines of one encoding after the other, so a whole batch of payloads is decoded at once: numpy finds
the operations of all of them, and expands all of them, without a loop over bytes. The one exception is `qoi` of colour,
whose every pixel depends on a table that the pixels before it have filled: it is decoded operation by operation.

Every decoder gives the pixels' bytes of all payloads, one after the other, and how many bytes each payload gave.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .formats import GRAY8, RAW8, RGB888, PixelFormat
from .packet import Malformed

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

Bytes = npt.NDArray[np.uint8]
Counts = npt.NDArray[np.int64]


def decode(encoding: int, unused: int, payloads: Sequence[bytes], pixel_format: PixelFormat) -> tuple[Bytes, Counts]:
    """Decode payloads that share encoding, unused bits and format.

    Raises `Malformed` if any of them is; `decode` it alone to find which.
    """
    if encoding == RAW:
        return _raw(payloads, pixel_format)
    if encoding == RUN_LENGTH:
        return run_length(payloads, pixel_format.unit_bytes)
    if encoding == QOI and pixel_format.code == RGB888:
        lines = [_qoi_rgb(payload) for payload in payloads]
        return np.concatenate(lines), np.array([line.size for line in lines], np.int64)
    if encoding == QOI and pixel_format.code in (GRAY8, RAW8):
        return qoi_gray(payloads, 1 if pixel_format.code == GRAY8 else 2)
    if encoding == BITS and pixel_format.code == GRAY8:
        return _bits(payloads, unused)
    if encoding == BITS_RUN_LENGTH and pixel_format.code == GRAY8:
        return _bits_run_length(payloads)
    raise Malformed(f"encoding {NAMES.get(encoding, encoding)} of {pixel_format.name}")


def _lengths(payloads: Sequence[bytes]) -> Counts:
    return np.fromiter(map(len, payloads), np.int64, len(payloads))


def _raw(payloads: Sequence[bytes], pixel_format: PixelFormat) -> tuple[Bytes, Counts]:
    counts = _lengths(payloads)
    if np.any(counts % pixel_format.unit_bytes):
        raise Malformed("raw pixels that end within a unit")
    return np.frombuffer(b"".join(payloads), np.uint8), counts


def _bits(payloads: Sequence[bytes], unused: int) -> tuple[Bytes, Counts]:
    counts = _lengths(payloads) * 8 - unused
    if np.any(counts < 0):
        raise Malformed("more unused bits than bits")
    bits = np.unpackbits(np.frombuffer(b"".join(payloads), np.uint8), bitorder="little")
    if unused:
        ends = np.cumsum(counts + unused)
        keep = np.ones(bits.size, bool)
        keep[(ends[:, None] - np.arange(1, unused + 1)).ravel()] = False
        bits = bits[keep]
    return bits * np.uint8(255), counts


def run_length(payloads: Sequence[bytes], unit: int) -> tuple[Bytes, Counts]:
    """Undo `run-length` over units of `unit` bytes: controls below 128 precede literals, the others a repeated unit."""
    lengths = _lengths(payloads)
    data = np.frombuffer(b"".join(payloads), np.uint8)
    if data.size == 0:
        return data, lengths
    ends = np.cumsum(lengths)
    control = data.astype(np.int64)
    literal = control < 128
    # Where the next operation would be if one began here; a packet's end holds the chain back.
    following = np.arange(data.size) + 1 + unit * np.where(literal, control + 1, 1)
    last = np.repeat(ends, lengths)
    places = _chain(ends - lengths, np.minimum(following, last))
    if np.any(following[places] > last[places]):
        raise Malformed("a payload that ends within a run or literals")

    literal = literal[places]
    units = np.where(literal, control[places] + 1, control[places] - 126)
    first = np.cumsum(units) - units
    # The byte in `data` that each unit of the output begins with.
    step = np.repeat(np.where(literal, unit, 0), units)
    source = np.repeat(places + 1, units) + step * (np.arange(step.size) - np.repeat(first, units))
    out = data[source] if unit == 1 else data[source[:, None] + np.arange(unit)].reshape(-1)

    owner = np.searchsorted(ends, places, side="right")
    counts = np.bincount(owner, weights=units, minlength=len(payloads)).astype(np.int64)
    return out, counts * unit


def _chain(starts: Counts, following: Counts) -> Counts:
    """All places that one comes to from `starts` by `following`, in order; every step goes forward.

    Pointer doubling: after k rounds all places within 2^k steps are known, and a jump covers 2^k of them.
    """
    end = following.size
    jump = np.append(following, end)
    seen = np.zeros(end + 1, bool)
    seen[starts] = True
    known = np.flatnonzero(seen)
    while True:
        seen[jump[known]] = True
        more = np.flatnonzero(seen)
        if more.size == known.size:
            return more[more < end]
        known = more
        jump = jump[jump]


def _bits_run_length(payloads: Sequence[bytes]) -> tuple[Bytes, Counts]:
    if any(len(payload) < 2 for payload in payloads):
        raise Malformed("a payload without its number of pixels")
    pixels = np.array([payload[0] | payload[1] << 8 for payload in payloads], np.int64)
    packed, lengths = run_length([payload[2:] for payload in payloads], 1)
    if np.any(lengths != (pixels + 7) // 8):
        raise Malformed("a payload of another length than its number of pixels")
    bits = np.unpackbits(packed, bitorder="little")
    ends = np.cumsum(lengths * 8)
    place = np.arange(bits.size) - np.repeat(ends - lengths * 8, lengths * 8)
    return bits[place < np.repeat(pixels, lengths * 8)] * np.uint8(255), pixels


def qoi_gray(payloads: Sequence[bytes], lag: int) -> tuple[Bytes, Counts]:
    """Undo `qoi` of samples that are predicted by the one `lag` before: 1 for gray, 2 for a mosaic."""
    lengths = _lengths(payloads)
    data = np.frombuffer(b"".join(payloads), np.uint8)
    if data.size == 0:
        return data, lengths
    ends = np.cumsum(lengths)
    begins = np.zeros(data.size + 1, bool)
    begins[ends - lengths] = True
    begins[-1] = True

    # 0xFE takes the byte after it, which may be 0xFE as well: in a row of them every second one is an operation.
    place = np.arange(data.size)
    escape = data == 0xFE
    row_begins = escape & (begins[:-1] | ~np.concatenate(([False], escape[:-1])))
    escape &= (place - np.maximum.accumulate(np.where(row_begins, place, 0))) % 2 == 0
    if np.any(escape & begins[1:]):
        raise Malformed("a payload that ends within an operation")
    operation = ~np.concatenate(([False], escape[:-1]))
    places = np.flatnonzero(operation)
    code = data[places].astype(np.int64)
    if np.any(code == 0xFF):
        raise Malformed("a reserved operation")

    escape = code == 0xFE
    tag = code >> 6
    pixels = np.array([2, 3, 1, 0])[tag] + np.where(tag == 3, np.where(escape, 1, (code & 0x3F) + 1), 0)
    owner = np.searchsorted(ends, places, side="right")
    counts = np.bincount(owner, weights=pixels, minlength=len(payloads)).astype(np.int64)

    first = np.cumsum(pixels) - pixels
    difference = np.zeros(int(pixels.sum()), np.int64)
    two, three, one = (np.flatnonzero(tag == value) for value in range(3))
    difference[first[two]] = (code[two] >> 3) - 4
    difference[first[two] + 1] = (code[two] & 7) - 4
    for position in range(3):
        difference[first[three] + position] = (code[three] >> (4 - 2 * position) & 3) - 2
    difference[first[one]] = (code[one] & 0x3F) - 32

    # Sums begin anew with a line, at 0, and with a pixel given by its value.
    anew = np.zeros(difference.size, bool)
    line_starts = np.cumsum(counts) - counts
    for position in range(lag):
        begun = line_starts[counts > position] + position
        anew[begun] = True
    given = first[escape]
    difference[given] = data[places[escape] + 1]
    anew[given] = True

    out = np.empty(difference.size, np.uint8)
    lane = (np.arange(difference.size) - np.repeat(line_starts, counts)) % lag
    for position in range(lag):
        mine = np.flatnonzero(lane == position) if lag > 1 else slice(None)
        sums = np.cumsum(difference[mine])
        resets = np.flatnonzero(anew[mine])
        before = sums[resets] - difference[mine][resets]
        reach = np.diff(np.append(resets, sums.size))
        out[mine] = (sums - np.repeat(before, reach)).astype(np.uint8)
    return out, counts


def _qoi_rgb(payload: bytes) -> Bytes:
    """Undo `qoi` of one line of RGB888: a pixel is one number here, red in its low byte."""
    pixels: list[int] = []
    index = [0] * 64
    red = green = blue = pixel = 0
    at, end = 0, len(payload)
    try:
        while at < end:
            code = payload[at]
            at += 1
            if code >= 0xC0:
                if code < 0xFE:
                    pixels += [pixel] * (code - 0xBF)
                    # A run that begins the line puts its pixel into the index, too; later it is there already.
                    index[(3 * red + 5 * green + 7 * blue + 53) & 63] = pixel
                    continue
                if code == 0xFF:
                    raise Malformed("a reserved operation")
                red, green, blue = payload[at], payload[at + 1], payload[at + 2]
                at += 3
            elif code >= 0x80:
                second = payload[at]
                at += 1
                luma = code - 0xA0
                red = (red + luma + (second >> 4) - 8) & 255
                green = (green + luma) & 255
                blue = (blue + luma + (second & 15) - 8) & 255
            elif code >= 0x40:
                red = (red + (code >> 4 & 3) - 2) & 255
                green = (green + (code >> 2 & 3) - 2) & 255
                blue = (blue + (code & 3) - 2) & 255
            else:
                pixel = index[code]
                pixels.append(pixel)
                red, green, blue = pixel & 255, pixel >> 8 & 255, pixel >> 16
                index[(3 * red + 5 * green + 7 * blue + 53) & 63] = pixel
                continue
            pixel = red | green << 8 | blue << 16
            index[(3 * red + 5 * green + 7 * blue + 53) & 63] = pixel
            pixels.append(pixel)
    except IndexError:
        raise Malformed("a payload that ends within an operation") from None
    return np.array(pixels, "<u4").view(np.uint8).reshape(-1, 4)[:, :3].reshape(-1)
