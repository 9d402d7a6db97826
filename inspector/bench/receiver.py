"""How many bytes of the link a second the receiver takes, on one core.

    python bench/receiver.py [--seconds 1.0] [--image FILE]

Each row is a stream as a device sends it: VGA frames of a photograph, or of its edges, in one encoding, from FRAME to
END, in pieces of 256 KiB, as a port gives them whose bytes wait. Time is that of the processor, and the best of several
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

PHOTOGRAPHS = Path(__file__).parents[2] / "tests" / "data" / "photographs"
PIECE = 1 << 18


def edges(gray: np.ndarray) -> np.ndarray:
    """Make a map such as an edge detector gives: thin and sparse."""
    wide = gray.astype(np.int32)
    slope = np.abs(np.diff(wide, axis=1, prepend=wide[:, :1])) + np.abs(np.diff(wide, axis=0, prepend=wide[:1]))
    return np.where(slope > np.percentile(slope, 94), 255, 0).astype(np.uint8)


def measure(wire: bytes, pixels: bytes, seconds: float) -> tuple[float, int]:
    best, rounds, until = float("inf"), 0, time.perf_counter() + seconds
    while rounds < 3 or time.perf_counter() < until:
        receiver = Receiver()
        frames = []
        start = time.thread_time()
        for at in range(0, len(wire), PIECE):
            frames += [event for event in receiver.feed(wire[at : at + PIECE]) if isinstance(event, Frame)]
        best = min(best, time.thread_time() - start)
        rounds += 1
        if not all(frame.whole and frame.data.tobytes() == pixels for frame in frames) or not frames:
            raise SystemExit("the receiver did not give back what was sent")
    return best, rounds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=1.0, help="time a row")
    parser.add_argument("--frames", type=int, default=8, help="frames a stream")
    parser.add_argument("--image", type=Path, default=next(iter(sorted(PHOTOGRAPHS.glob("*.png"))), None))
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
    for name, code, pixels, encoding in rows:
        data = np.ascontiguousarray(pixels).tobytes()
        one = [device.frame_wire(0, number, code, pixels, encoding) for number in range(1, arguments.frames + 1)]
        wire = b"".join(one)
        best, _ = measure(wire, data, arguments.seconds)
        print(
            f"| {name} | `{encodings.NAMES[encoding]}` | {len(one[0]):,} | {len(wire) / best / 1e6:.1f} "
            f"| {len(data) * arguments.frames / best / 1e6:.1f} | {arguments.frames / best:.0f} |"
        )


if __name__ == "__main__":
    main()
