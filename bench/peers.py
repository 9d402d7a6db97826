#!/usr/bin/env python3
"""Runs our operations and their peers in turn, on the same photographs, one thread, and compares times and results.

    bench/peers.py                          all rows, as a Markdown table
    bench/peers.py --only canny --rounds 40 rows whose name contains "canny"
    bench/peers.py --write docs/peers.md    and put the table between the markers of that file

The peers are installed into bench/.venv, at the versions in bench/requirements.txt; ours and the Rust peers are built by
cargo, in release mode. Other programs make any of this slower, never faster: so the least of many short rounds counts,
and the two sides take turns within a round.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

HERE = Path(__file__).resolve().parent
VENV = HERE / ".venv"
REQUIREMENTS = HERE / "requirements.txt"
BEGIN, END = "<!-- table -->", "<!-- end of table -->"
# Libraries that would start threads of their own read these when they are loaded.
ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OPENCV_FOR_THREADS_NUM")}


def enter_environment():
    """Makes the virtual environment if it is not there or not the one asked for, and goes on in it."""
    python = VENV / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    stamp, wanted = VENV / "installed.txt", REQUIREMENTS.read_text()
    if not stamp.exists() or stamp.read_text() != wanted:
        print(f"installing the peers into {VENV} …", file=sys.stderr)
        venv.create(VENV, clear=True, with_pip=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", "-r", REQUIREMENTS], check=True, stdout=sys.stderr)
        stamp.write_text(wanted)
    if Path(sys.prefix).resolve() != VENV.resolve():
        environment = os.environ | ONE_THREAD
        sys.exit(subprocess.run([python, *sys.argv], env=environment).returncode)


def build_runner():
    """The path of our runner, built just now."""
    command = ["cargo", "build", "--release", "--package", "camif-bench", "--message-format=json-render-diagnostics"]
    built = subprocess.run(command, cwd=HERE.parent, check=True, stdout=subprocess.PIPE, text=True)
    messages = [json.loads(line) for line in built.stdout.splitlines()]
    return next(m["executable"] for m in messages if m.get("executable") and m["target"]["name"] == "camif-bench")


def options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", metavar="NAME", help="rows whose operation or peer contains NAME, in any case")
    parser.add_argument("--rounds", metavar="N", type=int, default=25, help="rounds of each side (default: 25)")
    parser.add_argument("--json", metavar="FILE", help="also write the numbers as JSON")
    parser.add_argument("--write", metavar="FILE", help=f"also replace what stands between {BEGIN} and {END} in FILE")
    chosen = parser.parse_args()
    if chosen.rounds < 1:
        parser.error("--rounds: at least 1")
    if chosen.write:
        text = Path(chosen.write).read_text()
        if not 0 <= text.find(BEGIN) < text.find(END):
            parser.error(f"--write: {chosen.write} has no {BEGIN} followed by {END}")
    return chosen


def replace_file(path, text):
    """Writes a file whole or not at all."""
    path = Path(path)
    with tempfile.NamedTemporaryFile("w", dir=path.resolve().parent, delete=False) as made:
        made.write(text)
    os.chmod(made.name, 0o644)
    os.replace(made.name, path)


def main():
    chosen = options()
    enter_environment()
    import measure  # needs what the environment holds
    import report
    from rows import rows

    with tempfile.TemporaryDirectory() as folder:
        photographs = measure.photographs(Path(folder))
        with measure.Runner(build_runner(), Path(folder)) as runner:
            wanted = [row for row in rows(photographs, runner) if not chosen.only or chosen.only.lower() in row.title().lower()]
            if not wanted:
                sys.exit(f"--only: no row contains {chosen.only!r}")
            conditions = report.Conditions()
            measured = measure.run(wanted, runner, chosen.rounds)
            conditions.end()
    table = report.markdown(measured, conditions, chosen.rounds)
    print(table)
    if chosen.json:
        replace_file(chosen.json, report.as_json(measured, conditions, chosen.rounds))
    if chosen.write:
        text = Path(chosen.write).read_text()
        before, after = text.split(BEGIN, 1)[0], text.split(END, 1)[1]
        replace_file(chosen.write, f"{before}{BEGIN}\n{table}\n{END}{after}")


if __name__ == "__main__":
    main()
