"""The encoding `qoi`, undone: of colour, and of one sample a pixel.

Reference: the Quite OK Image format's specification, https://qoiformat.org/qoi-specification.pdf; a payload is an image
of one line without header and end marker. `docs/link-protocol.md` has the operations for one sample a pixel.

A pixel of colour needs the index that the pixels before it have filled, so a line is serial; lines are not, and are
decoded together, a step for one operation of each (see `walk`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from .packet import Malformed
from .walk import BEYOND, Bytes, Counts, Places, lengths_of, walk

Words = npt.NDArray[np.uint64]
Integers = npt.NDArray[np.int64]

_INDEX, _DIFF, _LUMA, _RUN = range(4)
_GIVEN, _RESERVED = 0xFE, 0xFF
# As many lines as must share a step of numpy for it to cost less than an operation of each in Python.
_FEW = 20
# Lines that are put side by side together: few enough to stay in the cache.
_TOGETHER = 64


def _word(red: Integers, green: Integers, blue: Integers, first_place: int = 0) -> Words:
    """Pack a pixel, or a difference of pixels, into a word; its fourth byte is four times its place in the index.

    The place is (3 r + 5 g + 7 b + 53) mod 64. That is linear, so places can be added like the channels; what four
    times a place has above 255 falls out of the byte. The 53 comes in with the first pixel. The line that a pixel is
    of stands above: a word without its lowest 26 bits is the place of the pixel among the places of all lines.
    """
    place = 4 * (3 * red + 5 * green + 7 * blue + first_place)
    return (red & 255 | (green & 255) << 8 | (blue & 255) << 16 | (place & 255) << 24).astype(np.uint64)


_BLACK = np.uint64(4 * 53 << 24)


class _Tables(NamedTuple):
    """What a first byte says, and, in `change`, a first and a second one: the first is the higher."""

    length: npt.NDArray[np.int32]
    pixels: Bytes
    change: Words


@lru_cache(maxsize=1)
def _colour_tables() -> _Tables:
    first = np.arange(256)
    tag = first >> 6
    length = np.where(tag == _LUMA, 2, np.where(first == _GIVEN, 4, 1)).astype(np.int32)
    length[_RESERVED] = BEYOND
    # What stands behind a payload changes nothing and is no pixel.
    pixels = np.where((tag == _RUN) & (first < _GIVEN), (first & 63) + 1, 1).astype(np.uint8)
    pixels[_RESERVED] = 0
    both = np.arange(1 << 16)
    code, second = both >> 8, both & 255
    luma = (code & 63) - 32
    small = _word((code >> 4 & 3) - 2, (code >> 2 & 3) - 2, (code & 3) - 2)
    large = _word(luma + (second >> 4) - 8, luma, luma + (second & 15) - 8)
    change = np.where(code >> 6 == _DIFF, small, np.where(code >> 6 == _LUMA, large, np.uint64(0)))
    return _Tables(length, pixels, change)


def colour(payloads: Sequence[bytes]) -> tuple[Bytes, Counts]:
    """Undo `qoi` of RGB888."""
    lengths = lengths_of(payloads)
    if lengths.sum() < _FEW * lengths.max():
        lines = [_one_by_one(payload) for payload in payloads]
        return np.concatenate(lines), np.array([line.size for line in lines], np.int64)
    tables = _colour_tables()
    found = walk(payloads, tables.length, _RESERVED)
    data = found.data
    pairs = data[:-1].astype(np.uint16) << 8
    pairs |= data[1:]
    index = _Index(found.steps, len(payloads))
    words, times = [], []
    for places in found.blocks():
        first = data.take(places, mode="clip")
        tables.change.take(pairs.take(places, mode="clip"), out=index.change, mode="clip")
        given = np.flatnonzero(first == _GIVEN)
        if given.size:
            at = places.reshape(-1)[given]
            red, green, blue = (data[at + channel].astype(np.int64) for channel in (1, 2, 3))
            index.change.reshape(-1)[given] = _word(red, green, blue, 53)
        words.append(index.steps(first, given).copy())
        times.append(tables.pixels.take(first, mode="clip"))
    counts = _counts(times, len(payloads))
    out, end = np.empty((counts.sum(), 3), np.uint8), 0
    for pixels in _side_by_side(words, times):
        end += pixels.size
        for channel, part in enumerate(pixels.view(np.uint8).reshape(-1, 4).T[:3]):
            out[end - pixels.size : end, channel] = part
    return out.reshape(-1), counts * 3


def _counts(times: list[Bytes], lines: int) -> Counts:
    """Add up the pixels of each line, of which each block has as many in each step as it says."""
    return sum((some.sum(axis=0, dtype=np.int64) for some in times), start=np.zeros(lines, np.int64))


def _side_by_side(values: list[npt.NDArray[Any]], times: list[Bytes]) -> Iterator[npt.NDArray[Any]]:
    """Give what blocks of steps found line by line, each value as many times as it stands for: a few lines together."""
    for begin in range(0, values[0].shape[1] if values else 0, _TOGETHER):
        some = slice(begin, begin + _TOGETHER)
        value, count = (
            np.concatenate([block[:, some] for block in blocks]).T.reshape(-1) for blocks in (values, times)
        )
        yield value.repeat(count)


class _Index:
    """The pixels that lines have had, all in one array, so that one call reads whatever pixels operations begin with.

    First for each line the 64 places of its index; then, each with a pixel for each line, a row of zeros, the row of
    the last pixels, and the rows of the steps that follow.

    Attributes:
        change: what a step adds to the pixel that it begins with, a row of words for each; to be filled in.
    """

    def __init__(self, steps: int, lines: int) -> None:
        """Begin all lines: black before them, and in their indices."""
        number = np.arange(lines, dtype=np.uint64) << np.uint64(32)
        self._lines = lines
        self._pixels: Words = np.empty((64 + 2 + steps) * lines, np.uint64)
        self._pixels[: 64 * lines] = (number | _BLACK).repeat(64)
        self._rows = self._pixels[64 * lines :].reshape(-1, lines)
        self._rows[0] = number
        self._rows[-1] = number | _BLACK
        self._before = np.arange(65 * lines, (65 + steps) * lines).reshape(steps, lines)
        self._begins = np.empty_like(self._before)
        self.change: Words = np.empty((steps, lines), np.uint64)
        results = self._rows[2:]
        self._steps = list(zip(self._begins, self.change.view(np.uint8), results, results.view(np.uint8), strict=True))

    def steps(self, first: Bytes, given: Integers) -> npt.NDArray[np.uint32]:
        """Give the pixels after all steps of a block, a row for each: a pixel there was, and a change to it.

        It is the one before, or that at a place of the index, or where a pixel is `given`, zero. The hot loop: each of
        its four calls costs about a third of a microsecond for all lines together.
        """
        pixels, lines, begins = self._pixels, self._lines, self._begins.reshape(-1)
        self._rows[1] = self._rows[-1]
        self._begins[:] = self._before
        indexed = np.flatnonzero(first < 64)
        begins[indexed] = indexed % lines << 6 | first.reshape(-1)[indexed]
        begins[given] = given % lines + 64 * lines
        begun, place = np.empty(lines, np.uint64), np.empty(lines, np.uint64)
        begun_bytes, place_index, below_place = begun.view(np.uint8), place.view(np.intp), np.uint64(26)
        add, shift, take = np.add, np.right_shift, pixels.take
        for source, change, row, row_bytes in self._steps:
            take(source, out=begun, mode="clip")
            add(begun_bytes, change, row_bytes)
            shift(row, below_place, place)
            pixels[place_index] = row
        return self._rows[2:].view("<u4")[:, ::2]


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
        total: what its differences come to: the last of its pixels less the one before it.
        keep: 255, or 0 if its pixel does not depend on the one before.
        back: for an operation of two pixels, or three, by how much the last but one is less than the last, and in the
            high byte the one before that.
    """

    length: npt.NDArray[np.int32]
    pixels: npt.NDArray[np.int32]
    total: Bytes
    keep: Bytes
    back: npt.NDArray[np.uint16]


@lru_cache(maxsize=1)
def _sample_tables() -> _SampleTables:
    code = np.arange(256)
    tag = code >> 6
    two = (code >> 3 & 7) - 4, (code & 7) - 4
    three = (code >> 4 & 3) - 2, (code >> 2 & 3) - 2, (code & 3) - 2
    total = np.select([tag == 0, tag == 1, tag == 2], [sum(two), sum(three), (code & 63) - 32], 0)
    pixels = np.select([tag == 0, tag == 1, tag == 2], [2, 3, 1], (code & 63) + 1)
    pixels[_GIVEN], pixels[_RESERVED] = 1, 0
    last = np.select([tag == 0, tag == 1], [two[1], three[2]], 0)
    return _SampleTables(
        length=np.select([code == _GIVEN, code == _RESERVED], [2, BEYOND], 1).astype(np.int32),
        pixels=pixels.astype(np.int32),
        total=(total & 255).astype(np.uint8),
        keep=np.where(code == _GIVEN, 0, 255).astype(np.uint8),
        back=((last & 255) | (last + three[1] & 255) << 8).astype(np.uint16),
    )


def samples(payloads: Sequence[bytes], lag: int) -> tuple[Bytes, Counts]:
    """Undo `qoi` of samples that are predicted by the one `lag` before: 1 for gray, 2 for a mosaic."""
    return _gray(payloads) if lag == 1 else _mosaic(payloads)


def _gray(payloads: Sequence[bytes]) -> tuple[Bytes, Counts]:
    """Undo `qoi` of gray: a step gives the last pixel of an operation of each line, the others follow from that."""
    tables = _sample_tables()
    found = walk(payloads, tables.length, _RESERVED)
    shape = found.steps, len(payloads)
    last, keep, total = (np.zeros(shape, np.uint8) for _ in range(3))
    end, pixels = (np.zeros(shape, np.int32) for _ in range(2))
    # The first step goes on from where the last one of the block before was.
    steps = list(zip([last[-1], *last], keep, total, last, [end[-1], *end], pixels, end, strict=False))
    values, times = [], []
    several: list[tuple[Integers, Places, Bytes]] = []
    for places in found.blocks():
        code = found.data.take(places, mode="clip")
        tables.keep.take(code, out=keep, mode="clip")
        tables.total.take(code, out=total, mode="clip")
        tables.pixels.take(code, out=pixels, mode="clip")
        given = np.flatnonzero(code == _GIVEN)
        if given.size:
            total.reshape(-1)[given] = found.data[places.reshape(-1)[given] + 1]
        for begun, kept, added, pixel, begin, more, until in steps:
            np.bitwise_and(begun, kept, pixel)
            np.add(pixel, added, pixel)
            np.add(begin, more, until)
        values.append(last.copy())
        times.append(pixels.astype(np.uint8))
        several += _before_last(code, last, end)

    counts = _counts(times, len(payloads))
    out = np.concatenate([np.empty(0, np.uint8), *_side_by_side(values, times)])
    begins = np.cumsum(counts) - counts
    for line, place, value in several:
        out[begins.take(line) + place] = value
    return out, counts


def _before_last(code: Bytes, last: Bytes, end: Places) -> Iterator[tuple[Integers, Places, Bytes]]:
    """Give the pixels before the last one of operations of two and of three, each with its line and its place there."""
    two = np.flatnonzero(code < 128)
    code, pixel, place = code.take(two), last.take(two), end.take(two)
    back = _sample_tables().back.take(code, mode="clip")
    line = two % last.shape[1]
    yield line, place - 2, pixel - back.astype(np.uint8)
    three = np.flatnonzero(code >= 64)
    yield line.take(three), place.take(three) - 3, pixel.take(three) - (back.take(three) >> 8).astype(np.uint8)


class _MosaicTables(NamedTuple):
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
def _mosaic_tables() -> _MosaicTables:
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
    return _MosaicTables(
        length=np.select([code == _GIVEN, code == _RESERVED], [2, BEYOND], 1).astype(np.int32),
        pixels=np.where(run, (code & 63) + 1, several).astype(np.int32),
        differences=differences.view("<u4").reshape(-1),
        there=there.view("<u4").reshape(-1),
        times=times.view("<u4").reshape(-1),
    )


def _mosaic(payloads: Sequence[bytes]) -> tuple[Bytes, Counts]:
    """Undo `qoi` of a mosaic, whose samples are predicted by the one two before."""
    tables = _mosaic_tables()
    found = walk(payloads, tables.length)
    places, operations = found.in_order()
    code = found.data.take(places, mode="clip")
    until = np.zeros(code.size + 1, np.int32)
    np.cumsum(tables.pixels.take(code, mode="clip"), out=until[1:])
    counts = np.diff(until[np.cumsum(operations)], prepend=0).astype(np.int64)

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
    for position in range(2):
        anew[begins[counts > position] + position] = True
    anew[until[escape]] = True
    out = np.empty_like(difference)
    lane = (np.arange(difference.size) - np.repeat(begins, counts)) % 2
    for position in range(2):
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
