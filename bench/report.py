"""The table, and under what conditions it was measured."""

import datetime
import json
import os
import platform
import subprocess
from importlib.metadata import version
from pathlib import Path

PEERS = ("opencv-python-headless", "numpy", "pillow", "imagequant", "scikit-image")
RUST_PEERS = ("clipline", "imageproc", "quantette")
ROOT = Path(__file__).resolve().parent.parent


def processor():
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    model = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "unknown")
    flags = next((line for line in lines if line.startswith("flags")), "").split()
    return f"{model}, {'with' if 'avx2' in flags else 'without'} AVX2"


def rust_versions():
    packages = json.loads(
        subprocess.run(
            ["cargo", "metadata", "--format-version=1", "--locked"], cwd=ROOT, check=True, stdout=subprocess.PIPE
        ).stdout
    )["packages"]
    nodes = {package["name"]: package["version"] for package in packages if package["name"] in RUST_PEERS}
    return [f"{name} {nodes[name]}" for name in RUST_PEERS]


def load():
    return os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")


class Conditions:
    """The machine and what else it was doing."""

    def __init__(self):
        self.started, self.load_before, self.load_after = datetime.datetime.now(), load(), None

    def end(self):
        self.load_after = load()

    def sentence(self, rounds):
        rustc = subprocess.run(["rustc", "--version"], check=True, stdout=subprocess.PIPE, text=True).stdout.split()[1]
        versions = [f"{name} {version(name)}" for name in PEERS] + rust_versions()
        return (
            f"Measured {self.started:%Y-%m-%d} on {os.cpu_count()} × {processor()}; {rounds} rounds; load average "
            f"{self.load_before:.1f} before and {self.load_after:.1f} after (this program makes 1 of it). rustc {rustc}, "
            f"Python {platform.python_version()}, {', '.join(versions)}."
        )


def milliseconds(value):
    return f"{value:.3f}" if value < 1 else f"{value:.2f}"


def line(measured):
    row = measured.row
    verdict = {None: "", True: "yes", False: "**no**"}[measured.met()]
    cells = (
        row.operation,
        row.peer,
        *map(milliseconds, (measured.ours.least(), measured.ours.median(), measured.peer.least(), measured.peer.median())),
        f"{measured.ratio():.2f}",
        "" if row.bar is None else f"≤ {row.bar}",
        verdict,
        measured.compared,
    )
    return f"| {' | '.join(cells)} |"


def markdown(measured, conditions, rounds):
    head = (
        "| operation | peer | ours, min | median | peer, min | median | ratio of minima | bar | met | results compared |",
        "|---|---|---:|---:|---:|---:|---:|---:|---|---|",
    )
    note = f"Milliseconds. {conditions.sentence(rounds)}"
    return "\n".join((*head, *map(line, measured), "", note))


def as_json(measured, conditions, rounds):
    rows = [
        {
            "operation": m.row.operation,
            "peer": m.row.peer,
            "ours_min_ms": m.ours.least(),
            "ours_median_ms": m.ours.median(),
            "peer_min_ms": m.peer.least(),
            "peer_median_ms": m.peer.median(),
            "ratio": m.ratio(),
            "bar": m.row.bar,
            "met": m.met(),
            "compared": m.compared,
        }
        for m in measured
    ]
    return json.dumps({"conditions": conditions.sentence(rounds), "rows": rows}, indent=2, ensure_ascii=False) + "\n"
