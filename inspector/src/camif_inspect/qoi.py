"""The encoding `qoi`, undone: of colour, and of one sample a pixel.

Reference: the Quite OK Image format's specification, https://qoiformat.org/qoi-specification.pdf; a payload is an image
of one line without header and end marker. `docs/link-protocol.md` has the operations for one sample a pixel.

A pixel of colour needs the index that the pixels before it have filled, so a line is serial; lines are not, and are
decoded together, a step for one operation of each (see `walk`).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from .packet import Malformed
from .walk import Bytes, Counts, lengths_of, walk

Words = npt.NDArray[np.uint32]
Integers = npt.NDArray[np.int64]

_INDEX, _DIFF, _LUMA, _RUN = range(4)
_GIVEN, _RESERVED = 0xFE, 0xFF
# Behind a payload stands a run: it changes nothing, and is not counted.
_BEHIND = 0xC0
# Steps that are prepared together: few enough to stay in the cache.
_BLOCK = 64
# As many lines as must share a step of numpy for it to cost less than an operation of each in Python.
_FEW = 20


def _word(red: Integers, green: Integers, blue: Integers) -> Words:
    """Pack a pixel, or a difference of pixels, into a word; the high byte is four times its place in the index.

    The place is (3 r + 5 g + 7 b + 53) mod 64. That is linear, so places can be added like the channels; what four
    times a place has above 255 falls out of the byte. The 53 comes in with the first pixel.
    """
    place = 4 * (3 * red + 5 * green + 7 * blue)
    return (red & 255 | (green & 255) << 8 | (blue & 255) << 16 | (place & 255) << 24).astype(np.uint32)


_BLACK = np.uint32(4 * 53 << 24)


class _Tables(NamedTuple):
    """What a first byte says, and, in `change`, a first and a second one: the first is the higher."""

    length: npt.NDArray[np.int32]
    pixels: Bytes
    keep: Words
    change: Words


@lru_cache(maxsize=1)
def _colour_tables() -> _Tables:
    first = np.arange(256)
    tag = first >> 6
    given = first == _GIVEN
    length = np.where(tag == _LUMA, 2, np.where(given, 4, 1)).astype(np.int32)
    pixels = np.where((tag == _RUN) & (first < _GIVEN), (first & 63) + 1, 1).astype(np.uint8)
    keep = np.where((tag == _INDEX) | given, 0, 0xFFFF_FFFF).astype(np.uint32)
    both = np.arange(1 << 16)
    code, second = both >> 8, both & 255
    luma = (code & 63) - 32
    small = _word((code >> 4 & 3) - 2, (code >> 2 & 3) - 2, (code & 3) - 2)
    large = _word(luma + (second >> 4) - 8, luma, luma + (second & 15) - 8)
    change = np.where(code >> 6 == _DIFF, small, np.where(code >> 6 == _LUMA, large, 0)).astype(np.uint32)
    return _Tables(length, pixels, keep, change)


def colour(payloads: Sequence[bytes]) -> tuple[Bytes, Counts]:
    """Undo `qoi` of RGB888."""
    lengths = lengths_of(payloads)
    if lengths.sum() < _FEW * lengths.max():
        lines = [_one_by_one(payload) for payload in payloads]
        return np.concatenate(lines), np.array([line.size for line in lines], np.int64)
    tables = _colour_tables()
    found = walk(payloads, tables.length, _BEHIND)
    data, places = found.data, found.places
    words = np.empty(places.shape, np.uint32)
    pixels = np.empty(places.shape, np.uint8)
    index = _Index(places.shape[1])
    for begin in range(0, places.shape[0], _BLOCK):
        block = slice(begin, begin + _BLOCK)
        first = data.take(places[block], mode="clip")
        if np.any(first == _RESERVED):
            raise Malformed("a reserved operation")
        change = tables.change.take(first.astype(np.uint16) << 8 | data.take(places[block] + 1), mode="clip")
        given = np.flatnonzero(first == _GIVEN)
        if given.size:
            at = places[block].reshape(-1)[given]
            red, green, blue = (data[at + channel].astype(np.int64) for channel in (1, 2, 3))
            change.reshape(-1)[given] = _word(red, green, blue) + _BLACK
        index.steps(first, tables.keep.take(first, mode="clip"), change, words[block])
        np.multiply(tables.pixels.take(first, mode="clip"), places[block] != found.ends, out=pixels[block])

    flat = np.repeat(np.ascontiguousarray(words.T).reshape(-1), np.ascontiguousarray(pixels.T).reshape(-1))
    out = np.empty((flat.size, 3), np.uint8)
    for channel, part in enumerate(flat.view(np.uint8).reshape(-1, 4).T[:3]):
        out[:, channel] = part
    return out.reshape(-1), pixels.sum(axis=0, dtype=np.int64) * 3


class _Index:
    """The pixels that lines have had: for each line the last one, and one for each place of its index."""

    def __init__(self, lines: int) -> None:
        """Begin all lines: black before them, and in their indices."""
        self._own: Words = np.arange(0, lines << 6, 64, dtype=np.uint32)
        # Behind all indices lies what is read where nothing is: zero.
        self._pixels = np.full((lines << 6) + 1, _BLACK, np.uint32)
        self._pixels[-1] = 0
        self._last = np.full(lines, _BLACK, np.uint32)

    def steps(self, first: Bytes, keep: Words, change: Words, words: Words) -> None:
        """Give the pixels after some steps, a row for each: the one before or nothing, and a change or the index's.

        The hot loop: each of its calls costs about half a microsecond for all lines together.
        """
        pixels, own, last = self._pixels, self._own, self._last
        read = np.where(first < 64, first + own, np.uint32(pixels.size - 1)).astype(np.intp)
        indexed, place = np.empty_like(last), np.empty_like(last)
        as_bytes, changes = words.view(np.uint8), change.view(np.uint8)
        for word, parts, kept, added, source in zip(words, as_bytes, keep, changes, read, strict=True):
            np.bitwise_and(last, kept, out=word)
            np.add(parts, added, out=parts)
            np.take(pixels, source, out=indexed, mode="clip")
            np.bitwise_or(word, indexed, out=word)
            np.right_shift(word, 26, out=place)
            np.bitwise_or(place, own, out=place)
            pixels[place] = word
            last = word
        self._last = last.copy()


def _one_by_one(payload: bytes) -> Bytes:
    """Undo `qoi` of one line of RGB888, one operation after the other: a pixel is one number, red in its low byte."""
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


class _SampleTables(NamedTuple):
    """What a first byte says.

    Attributes:
        length: bytes of its operation.
        pixels: pixels of its operation.
        differences: up to three differences of pixels, in bytes from the low one on.
        there: for each byte of those, 1 if it is one.
        times: for each byte of those, for how many pixels it stands.
    """

    length: npt.NDArray[np.int32]
    pixels: npt.NDArray[np.int32]
    differences: npt.NDArray[np.uint32]
    there: npt.NDArray[np.uint32]
    times: npt.NDArray[np.uint32]


@lru_cache(maxsize=1)
def _sample_tables() -> _SampleTables:
    code = np.arange(256)
    tag = code >> 6
    run = (tag == _RUN) & (code < _GIVEN)
    several = np.array((2, 3, 1, 1))[tag]
    differences = np.zeros((256, 4), np.uint8)
    for position in range(3):
        two = (code >> 3 - 3 * position & 7) - 4 if position < 2 else 0 * code
        three = (code >> 4 - 2 * position & 3) - 2
        one = (code & 63) - 32 if position == 0 else 0 * code
        differences[:, position] = np.select([tag == 0, tag == 1, tag == 2], [two, three, one], 0) & 255
    there = (np.arange(4) < several[:, None]).astype(np.uint8)
    times = np.ones((256, 4), np.uint8)
    times[run, 0] = (code[run] & 63) + 1
    return _SampleTables(
        length=np.where(code == _GIVEN, 2, 1).astype(np.int32),
        pixels=np.where(run, (code & 63) + 1, several).astype(np.int32),
        differences=differences.view("<u4").reshape(-1),
        there=there.view("<u4").reshape(-1),
        times=times.view("<u4").reshape(-1),
    )


def samples(payloads: Sequence[bytes], lag: int) -> tuple[Bytes, Counts]:
    """Undo `qoi` of samples that are predicted by the one `lag` before: 1 for gray, 2 for a mosaic."""
    tables = _sample_tables()
    found = walk(payloads, tables.length)
    places = found.in_order()
    code = found.data.take(places, mode="clip")
    if np.any(code == _RESERVED):
        raise Malformed("a reserved operation")
    until = np.zeros(code.size + 1, np.int32)
    np.cumsum(tables.pixels.take(code, mode="clip"), out=until[1:])
    counts = np.diff(until[np.cumsum(found.operations)], prepend=0).astype(np.int64)

    # Each operation has bytes for three differences; those that are there become pixels, that of a run many.
    there = np.flatnonzero(tables.there.take(code, mode="clip").view(bool))
    differences = tables.differences.take(code, mode="clip").view(np.uint8)
    escape = np.flatnonzero(code == _GIVEN)
    differences[4 * escape] = found.data[places[escape] + 1]
    difference = differences.take(there, mode="clip")
    if difference.size < until[-1]:
        difference = np.repeat(difference, tables.times.take(code, mode="clip").view(np.uint8).take(there, mode="clip"))

    # Sums begin anew with a line, at 0, and with a pixel given by its value.
    anew = np.zeros(difference.size, bool)
    begins = np.cumsum(counts) - counts
    for position in range(lag):
        anew[begins[counts > position] + position] = True
    anew[until[escape]] = True
    if lag == 1:
        return _sums(difference, anew), counts
    out = np.empty_like(difference)
    lane = (np.arange(difference.size) - np.repeat(begins, counts)) % lag
    for position in range(lag):
        mine = np.flatnonzero(lane == position)
        out[mine] = _sums(difference[mine], anew[mine])
    return out, counts


def _sums(difference: Bytes, anew: npt.NDArray[np.bool_]) -> Bytes:
    """Add up modulo 256, from nothing at each place that is marked."""
    sums = np.cumsum(difference, dtype=np.uint8)
    starts = np.flatnonzero(anew)
    before = sums[starts] - difference[starts]
    sums -= np.repeat(before, np.diff(np.append(starts, sums.size)))
    return sums
