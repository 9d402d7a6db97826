"""How many frames a second `host-sim stream` gets over a line of a given rate, received by this package.

    cargo build --release -p host-sim
    python bench/frames.py [--seconds 10] [--image FILE] [--rate BAUD ...] [--host-sim PROGRAM]

Each row is a VGA stream of one picture in one encoding; each column a rate of the line. Nothing is computed: pixel
clocks go through the simulated block, the driver and the link's sender, then through a socket that takes no more bytes
than the line would, into the inspector's receiver. Frames are counted from the end of one to the end of the last, and
must all be whole; bytes are those that came meanwhile, heartbeats and all.

The rates are two of a UART, and 12,160,000 baud, which stands for USB at full speed: at most 19 bulk packets of 64
bytes fit a frame of 1 ms (USB 2.0, table 5-9), so 1,216,000 bytes a second, and ten bits are a byte here.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import threading
import time
from dataclasses import dataclass
from pathlib import Path

import camif_inspect
from camif_inspect import Command, Frame, encodings

TOP = Path(__file__).parents[2]
RATES = (921_600, 3_000_000, 12_160_000)
# The camera: more frames a second than any line here takes, and no colour lost on its wires.
CAMERA, PROFILE = 80, "vga-rgb888"
SENDERS_CHOICE = encodings.SENDER_CHOOSES

# What a row sends: its name, the stream and what makes it, and the encoding.
ROWS = (
    ("VGA `rgb888`, `raw`", "raw", "", encodings.RAW),
    ("VGA `rgb888`, `qoi`", "raw", "", encodings.QOI),
    ("VGA `gray8`, `raw`", "raw", "gray", encodings.RAW),
    ("VGA `gray8`, `qoi`", "raw", "gray", encodings.QOI),
    ("VGA edges, `auto`", "edges", "gray|canny:low=50,high=150", SENDERS_CHOICE),
)


@dataclass(frozen=True)
class Result:
    """What a line brought: frames, the bytes meanwhile, and the time it took, in seconds."""

    frames: int
    bytes: int
    seconds: float


def measure(program: Path, image: Path, stream: str, stages: str, encoding: int, baud: int, seconds: float) -> Result:
    """Play the device and receive for a time, at least two frames."""
    command = [program, "stream", "--tcp", "127.0.0.1:0", "--image", image, "--profile", PROFILE]
    command += ["--baud", baud, "--rate", CAMERA]
    command += ["--stopped", "--streams", stream, *(["--stages", f"{stream}={stages}"] if stages else [])]
    device = subprocess.Popen(
        [str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        url = device.stdout.readline().strip() if device.stdout else ""
        if not url:
            raise SystemExit(f"host-sim did not start: {device.stderr.read() if device.stderr else ''}")
        ends: list[tuple[float, int, bool]] = []
        changed = threading.Event()
        with camif_inspect.open(url) as camera:

            def arrived(event: object) -> None:
                if isinstance(event, Frame):
                    ends.append((time.monotonic(), camera.receiver.counts.bytes, event.whole))
                    changed.set()

            camera.listen(arrived)
            camera.start()
            camera.demand(Command.ENCODING, bytes((255, encoding)))
            camera.demand(Command.START)
            while len(ends) < 3 or ends[-1][0] - ends[0][0] < seconds:
                changed.clear()
                if not changed.wait(60):
                    raise SystemExit(f"no frame in a minute from {url}")
        (began, before, _), (ended, after, _) = ends[0], ends[-1]
        if not all(whole for _, _, whole in ends):
            raise SystemExit("a frame was not whole")
        return Result(len(ends) - 1, after - before, ended - began)
    finally:
        device.terminate()
        device.communicate()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=10.0, help="least time a cell (%(default)s)")
    parser.add_argument("--image", type=Path, default=TOP / "tests/data/photographs/colour/coffee.jpg")
    parser.add_argument("--rate", type=int, nargs="*", default=RATES, metavar="BAUD")
    parser.add_argument("--only", default="", help="rows whose name has this")
    found = os.environ.get("CAMIF_HOST_SIM", TOP / "target/release/host-sim")
    parser.add_argument("--host-sim", type=Path, default=Path(found), help="the program (%(default)s)")
    arguments = parser.parse_args()
    if not arguments.host_sim.exists():
        parser.error(f"there is no {arguments.host_sim}: cargo build --release -p host-sim")
    columns = " | ".join(f"{baud:,} baud | of the line" for baud in arguments.rate)
    print(f"| frames | bytes a frame | {columns} |")
    print("|---|" + "---:|" * (1 + 2 * len(arguments.rate)))
    for name, stream, stages, encoding in ROWS:
        if arguments.only not in name:
            continue
        results = [
            measure(arguments.host_sim, arguments.image, stream, stages, encoding, baud, arguments.seconds)
            for baud in arguments.rate
        ]
        cells = [
            f"{result.frames / result.seconds:.3g} | {result.bytes / result.seconds / (baud / 10):.1%}"
            for baud, result in zip(arguments.rate, results, strict=True)
        ]
        print(f"| {name} | {results[0].bytes / results[0].frames:,.0f} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
