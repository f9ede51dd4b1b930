"""The parts of a sweep as tasks of Dask: python on_dask.py OUT PARTS [ADDRESS]

OUT is on a file system that every worker has. ADDRESS is that of a scheduler; without it,
Dask starts two workers on this computer.
"""

import subprocess
import sys
from pathlib import Path

from dask.distributed import Client, LocalCluster

HERE = Path(__file__).resolve().parent


def part(number: int, parts: int, out: str, here: str) -> str:
    shard = ["--shard", f"{number}/{parts}", "--threads", "1", "--out", out]
    done = subprocess.run(["sh", "sweep.sh", *shard], cwd=here, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    return done.stdout.splitlines()[0]


def main() -> None:
    out, parts = sys.argv[1], int(sys.argv[2])
    if len(sys.argv) > 3:
        client = Client(sys.argv[3])
    else:
        client = Client(LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None))
    tasks = client.map(part, range(1, parts + 1), parts=parts, out=out, here=str(HERE), pure=False)
    for line in client.gather(tasks):
        print(line)
    client.close()


if __name__ == "__main__":
    main()
