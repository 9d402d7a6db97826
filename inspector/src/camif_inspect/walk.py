"""Payloads taken apart into operations, many payloads at once.

Where an operation begins is known only when the one before it is: a payload has to be walked. But payloads are
independent, so all of them are walked together, one step for one operation of each: numpy's cost of a step is shared by
as many payloads as there are. A batch of lines takes as many steps as its longest line has operations.

    payloads      a b b c        places, a row for each step   a d f
                  d e e                                        b e f
                  f                                            b e *
                                                               c * *    * behind the payload's end
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .packet import Malformed

Bytes = npt.NDArray[np.uint8]
Counts = npt.NDArray[np.int64]
Places = npt.NDArray[np.int32]
Decoder = Callable[[Sequence[bytes]], tuple[Bytes, Counts]]

_STEPS = 64
# Bytes behind everything, so that the longest operation begun in time can be read.
ROOM = 8
# Cells of a walk that may be wasted because some payloads are much longer than the others.
_MOST_CELLS = 1 << 21


@dataclass(frozen=True)
class Walk:
    """Operations of several payloads.

    Attributes:
        data: all payloads, each with a byte behind it that is none of its own, and some zeros after all.
        places: where the operations begin in `data`, of shape (steps, payloads); `ends` once a payload is over.
        ends: for each payload the place of the byte behind it.
    """

    data: Bytes
    places: Places
    ends: Places

    @property
    def operations(self) -> Counts:
        """For each payload the number of its operations."""
        operations: Counts = np.sum(self.places != self.ends, axis=0, dtype=np.int64)
        return operations

    def in_order(self) -> Places:
        """Give the places of all operations, one payload after the other."""
        columns = np.ascontiguousarray(self.places.T).reshape(-1)
        return columns[np.flatnonzero(columns != np.repeat(self.ends, self.places.shape[0]))]


def lengths_of(payloads: Sequence[bytes]) -> Counts:
    """Give the bytes of each payload."""
    return np.fromiter(map(len, payloads), np.int64, len(payloads))


def walk(payloads: Sequence[bytes], length_of: npt.NDArray[np.int32], behind: int = 0) -> Walk:
    """Find the operations; `length_of` gives an operation's bytes by its first one, `behind` the byte to put at ends.

    Raises `Malformed` if a payload ends within an operation.
    """
    data = np.frombuffer(bytes((behind,)).join([*payloads, b""]) + bytes(ROOM), np.uint8)
    ends = (np.cumsum(lengths_of(payloads) + 1) - 1).astype(np.int32)
    following = np.take(length_of, data, mode="clip")
    following += np.arange(data.size, dtype=np.int32)
    # Who has come to his own end stays there. Who has overshot it comes to an end that is not his.
    following[ends] = ends
    following[-ROOM:] = data.size - 1

    row = np.concatenate((np.zeros(1, np.int32), ends[:-1] + np.int32(1)))
    blocks = []
    while not np.array_equal(row, ends):
        block = np.empty((_STEPS + 1, ends.size), np.int32)
        block[0] = row
        for step in range(_STEPS):
            np.take(following, block[step], out=block[step + 1], mode="clip")
        row = block[-1]
        blocks.append(block[:-1])
        if np.array_equal(row, block[-2]) and not np.array_equal(row, ends):
            raise Malformed("a payload that ends within an operation")
    places = np.concatenate(blocks) if blocks else np.empty((0, ends.size), np.int32)
    return Walk(data, places, ends)


def evenly(decoder: Decoder, payloads: Sequence[bytes]) -> tuple[Bytes, Counts]:
    """Decode payloads, those of like length together where lengths differ too much for one walk."""
    lengths = lengths_of(payloads)
    if int(lengths.max()) * lengths.size <= max(_MOST_CELLS, 4 * int(lengths.sum())):
        return decoder(payloads)
    decoded: list[Bytes] = [np.empty(0, np.uint8)] * lengths.size
    sizes = np.ceil(np.log2(lengths + 1)).astype(np.int64)
    for size in np.unique(sizes):
        group = np.flatnonzero(sizes == size)
        pixels, counts = decoder([payloads[int(place)] for place in group])
        for place, part in zip(group, np.split(pixels, np.cumsum(counts)[:-1]), strict=True):
            decoded[place] = part
    return np.concatenate(decoded), np.array([part.size for part in decoded], np.int64)
