"""One process, two workers, and two workers of which one is killed: the same bytes.

    HOST_SIM=target/release/host-sim python campaign/test_run.py
"""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time

from dask.distributed import Client, LocalCluster

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from run import run  # noqa: E402

HOST_SIM = str(pathlib.Path(os.environ.get("HOST_SIM", "target/release/host-sim")).resolve())
OPTIONS = ["--seeds", "6", "--clean", "20"]


def on_cluster(folder, name, kill):
    output = pathlib.Path(folder, name)
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        killed = []
        if kill:
            def later():
                # Once a part is at work.
                while not any(client.processing().values()):
                    time.sleep(0.01)
                pid = next(iter(client.run(os.getpid).values()))
                os.kill(pid, signal.SIGKILL)
                killed.append(pid)
            thread = threading.Thread(target=later)
            thread.start()
        status = run(client, HOST_SIM, 10, OPTIONS, output)
        if kill:
            thread.join()
            assert killed, "no worker was killed"
    assert status in (0, 1), status
    return output.read_bytes()


def main():
    with tempfile.TemporaryDirectory() as folder:
        alone = pathlib.Path(folder, "alone.jsonl")
        subprocess.run([HOST_SIM, "campaign", *OPTIONS, "-o", str(alone)], stdout=subprocess.DEVNULL)
        whole = alone.read_bytes()
        assert whole.count(b"\n") > 100
        assert on_cluster(folder, "two.jsonl", kill=False) == whole, "two workers"
        assert on_cluster(folder, "killed.jsonl", kill=True) == whole, "two workers, one killed"
    print("one process, two workers, and one of two killed: the same bytes")


if __name__ == "__main__":
    main()
