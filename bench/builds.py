#!/usr/bin/env python3
# How much slower the quick build's hot loops are than the published one's:
#
#     python3 bench/builds.py [ROUNDS]        from the root of the repository; 6 rounds take two minutes
#
# Builds `crepitus` with both profiles, runs `crepitus accuracy --quick` with
# one after the other, and compares the least CPU time of each point. The last
# column is the published build against itself: what the machine's noise makes.
import collections, csv, math, pathlib, subprocess, sys, tempfile

ROUNDS = int(sys.argv[1]) if len(sys.argv) > 1 else 6
BUILDS = {"release": "release", "again": "dist", "dist": "dist"}

for profile in sorted(set(BUILDS.values())):
    subprocess.run(["cargo", "build", "--locked", "--profile", profile], check=True)

least = {build: collections.defaultdict(lambda: math.inf) for build in BUILDS}
with tempfile.TemporaryDirectory() as folder:
    for round in range(ROUNDS):
        order = list(BUILDS)[round % 3 :] + list(BUILDS)[: round % 3]
        for number, build in enumerate(order):
            out = pathlib.Path(folder) / f"{round}-{number}"
            program = f"target/{BUILDS[build]}/crepitus"
            subprocess.run([program, "accuracy", "--quick", "--out", out], check=True, capture_output=True)
            for row in csv.DictReader((out / "points.csv").open()):
                point = tuple(row[column] for column in ("solver", "convention", "precision", "scene", "step_s"))
                least[build][point] = min(least[build][point], float(row["ns_per_step"]))


def mean(logarithms):
    return math.exp(sum(logarithms) / len(logarithms))


ratios = {build: collections.defaultdict(list) for build in ("release", "again")}
for point, published in least["dist"].items():
    for build, rungs in ratios.items():
        rungs[point[:3]].append(math.log(least[build][point] / published))
print(f"{'CPU time of a step, against dist':40} release  again")
for rung in sorted(ratios["release"]):
    print(f"{' '.join(rung):40}  {mean(ratios['release'][rung]):6.3f} {mean(ratios['again'][rung]):6.3f}")
everything = {build: mean([x for rung in rungs.values() for x in rung]) for build, rungs in ratios.items()}
print(f"{'geometric mean':40}  {everything['release']:6.3f} {everything['again']:6.3f}")
