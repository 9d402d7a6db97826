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

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from .packet import Malformed

Bytes = npt.NDArray[np.uint8]
Counts = npt.NDArray[np.int64]
Places = npt.NDArray[np.int32]
Decoder = Callable[[Sequence[bytes]], tuple[Bytes, Counts]]

# Steps of a block: few enough for what is made of a block to stay in the cache, and fewer for short payloads, which a
# block may outlast.
_STEPS, _STEPS_OF_SHORT, _SHORT = 64, 16, 256
# Longer than any payload: the length of what is no operation, which so ends within one.
BEYOND = 1 << 24
# Bytes behind everything, so that the longest operation begun in time can be read.
ROOM = 8
# Cells of a walk that may be wasted because some payloads are much longer than the others.
_MOST_CELLS = 1 << 21


@dataclass(frozen=True)
class Walk:
    """Operations of several payloads, one of each at a time.

    Attributes:
        data: all payloads, each with a byte behind it that is none of its own, and some zeros after all.
        ends: for each payload the place of the byte behind it.
        following: for each place that of the operation after the one that begins there.
        steps: of a block.
    """

    data: Bytes
    ends: Places
    following: Places
    steps: int

    def blocks(self) -> Iterator[Places]:
        """Give the places where operations begin, `steps` of each payload at a time, of shape (`steps`, payloads).

        Once a payload is over it is its end. A block is good until the next one is taken: memory that is used again
        need not be asked for, which costs as much as the walk.

        Raises `Malformed` if a payload ends within an operation.
        """
        ends, take = self.ends, self.following.take
        block = np.empty((self.steps + 1, ends.size), np.int32)
        block[-1, :1] = 0
        block[-1, 1:] = ends[:-1] + np.int32(1)
        rows = list(block)
        steps = list(pairwise(rows))
        while not np.all(block[-1] == ends):
            block[0] = block[-1]
            for row, after in steps:
                take(row, out=after, mode="clip")
            if np.all(block[-1] == block[-2]) and not np.all(block[-1] == ends):
                raise Malformed("a payload that ends within an operation, or holds a reserved one")
            yield block[:-1]

    def in_order(self) -> tuple[Places, Counts]:
        """Give the places of all operations, one payload after the other, and for each payload how many they are."""
        blocks = [block.T.copy("C") for block in self.blocks()]
        if not blocks:
            return np.empty(0, np.int32), np.zeros(self.ends.size, np.int64)
        places = np.concatenate(blocks, axis=1)
        there = places != self.ends[:, None]
        return places.reshape(-1).take(np.flatnonzero(there)), np.count_nonzero(there, axis=1)


def lengths_of(payloads: Sequence[bytes]) -> Counts:
    """Give the bytes of each payload."""
    return np.array(list(map(len, payloads)), np.int64)


def walk(payloads: Sequence[bytes], length_of: npt.NDArray[np.int32], behind: int = 0) -> Walk:
    """Prepare to find the operations of payloads, at the end of each of which `behind` is put.

    `length_of` gives an operation's bytes by its first one, and `BEYOND` for what is none.
    """
    data = np.frombuffer(bytes((behind,)).join([*payloads, b""]) + bytes(ROOM), np.uint8)
    lengths = lengths_of(payloads)
    ends = (np.cumsum(lengths + 1) - 1).astype(np.int32)
    following = length_of.take(data, mode="clip")
    following += np.arange(data.size, dtype=np.int32)
    # Who has come to his own end stays there. Who has overshot it comes to an end that is not his.
    following[ends] = ends
    following[-ROOM:] = data.size - 1
    return Walk(data, ends, following, _STEPS if lengths.max() >= _SHORT else _STEPS_OF_SHORT)


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
