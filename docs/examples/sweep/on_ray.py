"""The parts of a sweep as tasks of Ray: python on_ray.py OUT PARTS [ADDRESS]

OUT is on a file system that every node has. ADDRESS is that of a cluster; without it, Ray
starts one on this computer.
"""

import subprocess
import sys
from pathlib import Path

import ray

HERE = Path(__file__).resolve().parent
OUT, PARTS = sys.argv[1], int(sys.argv[2])


# A worker that is lost has its part begun again, where it was.
@ray.remote(num_cpus=1, max_retries=3)
def part(number: int) -> str:
    shard = ["--shard", f"{number}/{PARTS}", "--threads", "1", "--out", OUT]
    done = subprocess.run(["sh", "sweep.sh", *shard], cwd=HERE, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    return done.stdout.splitlines()[0]


ray.init(address=sys.argv[3] if len(sys.argv) > 3 else None, include_dashboard=False)
for line in ray.get([part.remote(number) for number in range(1, PARTS + 1)]):
    print(line)
