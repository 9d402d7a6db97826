#!/usr/bin/env python3
"""A campaign on a Dask cluster: each part is a run of `host-sim campaign --shard`, and `host-sim merge` joins them.

    python campaign/run.py --host-sim target/release/host-sim --parts 8 -o results.jsonl -- --seeds 100
    python campaign/run.py --scheduler tcp://head:8786 --host-sim /shared/host-sim --parts 64 -o results.jsonl -- --seeds 1000

Without --scheduler it runs on processes of this machine. A part whose worker dies runs again elsewhere, and the merged
file has the same bytes. Workers need host-sim (and the photographs) under the same path.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

from dask.distributed import Client, LocalCluster


def part(host_sim, index, count, options):
    """Runs part `index` of `count` and returns its results as bytes."""
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(folder, "part.jsonl")
        command = [host_sim, "campaign", *options, "--shard", f"{index}/{count}", "-o", str(output)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode == 2:
            raise RuntimeError(done.stderr)
        return output.read_bytes()


def run(client, host_sim, count, options, output):
    """Runs all parts and merges them; returns host-sim's exit status."""
    futures = [client.submit(part, host_sim, index + 1, count, options, pure=False) for index in range(count)]
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for index, results in enumerate(client.gather(futures)):
            paths.append(pathlib.Path(folder, f"{index}.jsonl"))
            paths[-1].write_bytes(results)
        return subprocess.run([host_sim, "merge", *map(str, paths), "-o", str(output)]).returncode


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--host-sim", default="host-sim", help="the program, as workers find it")
    parser.add_argument("--scheduler", help="address of a cluster; processes of this machine if not given")
    parser.add_argument("--workers", type=int, default=2, help="processes of this machine")
    parser.add_argument("--parts", type=int, default=8)
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("options", nargs="*", help="options of host-sim campaign, after --")
    given = parser.parse_args()
    cluster = given.scheduler or LocalCluster(n_workers=given.workers, threads_per_worker=1, dashboard_address=None)
    with Client(cluster) as client:
        sys.exit(run(client, given.host_sim, given.parts, given.options, given.output))


if __name__ == "__main__":
    main()
