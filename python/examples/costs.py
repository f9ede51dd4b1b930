"""What calls cost on this computer, as the table of the book's page."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import crepitus

STEP_S = 5e-5
STEPS = 200_000


def best_s(work: Callable[[], object], repeats: int = 5) -> float:
    """The shortest time of some repeats, s."""
    times = []
    for _ in range(repeats):
        begun = time.perf_counter()
        work()
        times.append(time.perf_counter() - begun)
    return min(times)


def main() -> None:
    scene = crepitus.Scene("slow-examination")
    joint = crepitus.Joint("coarse", omega_rad_s=1.0)
    joints = crepitus.Joints("coarse", 100, omega_rad_s=1.0)
    turns, speeds = np.full(STEPS, STEP_S), np.full(STEPS, 1.0)

    def everything() -> None:
        crepitus.run("everything", set={"duration_s": 10.0}, trace=False)

    def in_a_loop() -> None:
        step = joint.step
        for _ in range(STEPS):
            step(STEP_S, 1.0)

    def sampled() -> None:
        with crepitus.Device("sim") as device:
            device.stream(2.0)

    def in_threads() -> None:
        with ThreadPoolExecutor(2) as pool:
            list(pool.map(lambda _: crepitus.run(scene, trace=False), range(8)))

    def one_by_one() -> None:
        for _ in range(8):
            crepitus.run(scene, trace=False)

    rows = [
        ("a scene that ships, read and checked", best_s(lambda: crepitus.Scene("slow-examination"))),
        ("a run of 10 s at 50 µs with its trace", best_s(lambda: crepitus.run(scene))),
        ("the same without a trace", best_s(lambda: crepitus.run(scene, trace=False))),
        ("`everything` for 10 s, without a trace", best_s(everything)),
        (f"{STEPS:,} calls of `Joint.step`", best_s(in_a_loop)),
        (f"`Joint.steps` of {STEPS:,}", best_s(lambda: joint.steps(turns, speeds))),
        (
            f"`Joints.steps` of 100 × {STEPS // 100:,}",
            best_s(lambda: joints.steps(turns[: STEPS // 100], speeds[: STEPS // 100])),
        ),
        ("opening `sim`, and 2 s of its samples", best_s(sampled)),
        ("8 runs without a trace, one by one", best_s(one_by_one)),
        ("8 runs without a trace, in 2 threads", best_s(in_threads)),
    ]
    print(f"On {os.cpu_count()} cores; the fastest of five.\n")
    print("| what | ms |\n|---|---|")
    for what, seconds in rows:
        print(f"| {what} | {seconds * 1e3:.2f} |")


if __name__ == "__main__":
    main()
