"""Photographs, our runner, and rounds in which two sides take turns."""

import statistics
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable

import cv2
import numpy as np
import skimage.data

WIDTH, HEIGHT = 640, 480
NAMES = ("astronaut", "coffee", "chelsea", "rocket")
# A side's share of a round is about so long, so that neither is alone with a quiet machine.
SLICE_NS = 5_000_000
MOST_REPETITIONS = 40

cv2.setNumThreads(1)


@dataclass
class Photograph:
    name: str
    rgb: np.ndarray
    gray: np.ndarray
    rgb_path: Path
    gray_path: Path


def photographs(folder):
    """Those of scikit-image that come inside its wheel, at 640 × 480, in colour and in gray; raw for our runner."""
    made = []
    for name in NAMES:
        rgb = cv2.resize(getattr(skimage.data, name)(), (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)
        gray = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
        photograph = Photograph(name, rgb, gray, folder / f"{name}.rgb", folder / f"{name}.gray")
        rgb.tofile(photograph.rgb_path)
        gray.tofile(photograph.gray_path)
        made.append(photograph)
    return made


class Runner:
    """Our runner: a program that takes a command a line and answers with nanoseconds."""

    def __init__(self, path, folder):
        self.result = folder / "result"
        self.process = subprocess.Popen([path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.wait()

    def times(self, operation, path, repetitions, *result):
        print(operation, path or "-", repetitions, *result, file=self.process.stdin, flush=True)
        answer = self.process.stdout.readline().split()
        if not answer or answer[0] != "ok":
            sys.exit(f"the runner, asked for {operation}: {' '.join(answer) or 'no answer'}")
        return [int(nanoseconds) for nanoseconds in answer[1:]]

    def made(self, operation, path=None):
        """What an operation makes, as bytes."""
        self.times(operation, path, 1, self.result)
        return np.fromfile(self.result, np.uint8)


@dataclass
class Call:
    """A peer that Python calls. `before` is called ahead of each repetition, while the clock stands."""

    work: Callable
    before: Callable = lambda: None


@dataclass
class Row:
    """One line of the table: an operation of our runner, and for each picture the same by a peer: a `Call`, or the name
    of the runner's operation and the path. `compare` says in words how the results differ."""

    operation: str
    peer: str
    ours: str
    inputs: list  # for each picture the path that ours takes; [None] without pictures
    theirs: list
    bar: float | None
    compare: Callable[[], str]
    note: str = ""

    def title(self):
        return f"{self.operation} {self.peer} {self.ours}"


@dataclass
class Times:
    """Nanoseconds of one side, for each picture."""

    taken: list = field(default_factory=list)

    def least(self):
        return statistics.mean(min(taken) for taken in self.taken) / 1e6

    def median(self):
        return statistics.mean(statistics.median(taken) for taken in self.taken) / 1e6


@dataclass
class Measured:
    row: Row
    ours: Times
    peer: Times
    compared: str

    def ratio(self):
        return self.ours.least() / self.peer.least()

    def met(self):
        return None if self.row.bar is None else self.ratio() <= self.row.bar


def call_times(call, repetitions):
    taken = []
    call.before()
    call.work()
    for _ in range(repetitions):
        call.before()
        start = time.perf_counter_ns()
        call.work()
        taken.append(time.perf_counter_ns() - start)
    return taken


class Side:
    """One side of a row over one picture: how often it is repeated in a round, and what that took."""

    def __init__(self, times):
        self.times = times
        self.taken = []
        once = min(times(2))
        self.repetitions = max(2, min(MOST_REPETITIONS, SLICE_NS // max(once, 1)))

    def go(self):
        self.taken += self.times(self.repetitions)


def sides(row, runner):
    """For each picture our side and the peer's."""
    for path, theirs in zip(row.inputs, row.theirs, strict=True):
        ours = Side(lambda n, path=path: runner.times(row.ours, path, n))
        if isinstance(theirs, Call):
            peer = Side(lambda n, call=theirs: call_times(call, n))
        else:
            peer = Side(lambda n, theirs=theirs: runner.times(*theirs, n))
        yield ours, peer


def run(rows, runner, rounds):
    """Measures all rows. Every round visits every row, so that a busy minute does not fall on one row alone."""
    all_sides = [list(sides(row, runner)) for row in rows]
    for turn in range(rounds):
        print(f"\rround {turn + 1} of {rounds}", end="", file=sys.stderr, flush=True)
        for pairs in all_sides:
            for pair in pairs:
                for side in pair if turn % 2 == 0 else reversed(pair):
                    side.go()
    print(file=sys.stderr)
    measured = []
    for row, pairs in zip(rows, all_sides):
        ours, peer = (Times([pair[side].taken for pair in pairs]) for side in (0, 1))
        measured.append(Measured(row, ours, peer, row.compare()))
    return measured
