"""How many bytes of the link a second the receiver takes, on one core.

    python bench/receiver.py [--seconds 1.0] [--image FILE]

Each row is a stream as a device sends it: VGA frames of a photograph, or of its edges, in one encoding, from FRAME to
END, in pieces of 1 MiB, as a port gives them whose bytes wait. Time is that of the processor, and the best of several
rounds is given, because other work disturbs.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np
from PIL import Image

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
import device
from camif_inspect import encodings, formats
from camif_inspect.frame import Frame
from camif_inspect.receiver import Receiver

PHOTOGRAPHS = Path(__file__).parents[2] / "tests" / "data" / "photographs" / "colour"
PIECE = 1 << 20


def edges(gray: np.ndarray) -> np.ndarray:
    """Make a map such as an edge detector gives: thin and sparse."""
    wide = gray.astype(np.int32)
    slope = np.abs(np.diff(wide, axis=1, prepend=wide[:, :1])) + np.abs(np.diff(wide, axis=0, prepend=wide[:1]))
    return np.where(slope > np.percentile(slope, 94), 255, 0).astype(np.uint8)


def in_turns(colour: np.ndarray, gray: np.ndarray, sequence: int) -> bytes:
    """Send a frame and its edges line by line in turns, each line in the shortest of its encodings."""
    codes = (formats.RGB888, colour, (0, 1, 2)), (formats.GRAY8, edges(gray), (0, 1, 2, 3, 4))
    takes = [
        [device.frame_packets(stream, sequence, code, pixels, choice) for choice in choices]
        for stream, (code, pixels, choices) in enumerate(codes)
    ]
    return b"".join(
        min(packets, key=len) for place in zip(*(zip(*t, strict=True) for t in takes), strict=True) for packets in place
    )


def measure(wire: bytes, pixels: set[bytes], seconds: float) -> tuple[float, int]:
    best, rounds, until = float("inf"), 0, time.perf_counter() + seconds
    while rounds < 3 or time.perf_counter() < until:
        receiver = Receiver()
        frames = []
        start = time.thread_time()
        for at in range(0, len(wire), PIECE):
            frames += [event for event in receiver.feed(wire[at : at + PIECE]) if isinstance(event, Frame)]
        best = min(best, time.thread_time() - start)
        rounds += 1
        if not all(frame.whole and frame.data.tobytes() in pixels for frame in frames) or not frames:
            raise SystemExit("the receiver did not give back what was sent")
    return best, rounds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=1.0, help="time a row")
    parser.add_argument("--frames", type=int, default=8, help="frames a stream")
    parser.add_argument("--image", type=Path, default=next(iter(sorted(PHOTOGRAPHS.glob("*.*"))), None))
    arguments = parser.parse_args()
    picture = Image.open(arguments.image).convert("RGB").resize((640, 480))
    colour, gray = np.asarray(picture), np.asarray(picture.convert("L"))
    rows = (
        ("photograph, RGB888", formats.RGB888, colour, encodings.RAW),
        ("photograph, RGB888", formats.RGB888, colour, encodings.RUN_LENGTH),
        ("photograph, RGB888", formats.RGB888, colour, encodings.QOI),
        ("photograph, gray", formats.GRAY8, gray, encodings.RAW),
        ("photograph, gray", formats.GRAY8, gray, encodings.QOI),
        ("edges", formats.GRAY8, edges(gray), encodings.BITS),
        ("edges", formats.GRAY8, edges(gray), encodings.BITS_RUN_LENGTH),
        ("edges", formats.GRAY8, edges(gray), encodings.RUN_LENGTH),
        ("edges", formats.GRAY8, edges(gray), encodings.QOI),
    )
    print("| stream | encoding | bytes a frame | MB/s on the line | MB/s of pixels | frames/s |")
    print("|---|---|---:|---:|---:|---:|")

    def row(name: str, encoding: str, frames: list[bytes], pictures: list[np.ndarray]) -> None:
        pixels = [np.ascontiguousarray(picture).tobytes() for picture in pictures]
        size, wire = sum(map(len, pixels)), b"".join(frames)
        best, _ = measure(wire, set(pixels), arguments.seconds)
        print(
            f"| {name} | {encoding} | {len(frames[0]):,} | {len(wire) / best / 1e6:.1f} "
            f"| {size * len(frames) / best / 1e6:.1f} | {len(frames) / best:.0f} |"
        )

    numbers = range(1, arguments.frames + 1)
    for name, code, pixels, encoding in rows:
        frames = [device.frame_wire(0, number, code, pixels, encoding) for number in numbers]
        row(name, f"`{encodings.NAMES[encoding]}`", frames, [pixels])
    frames = [in_turns(colour, gray, number) for number in numbers]
    row("photograph and edges in turns", "shortest, line by line", frames, [colour, edges(gray)])


if __name__ == "__main__":
    main()
