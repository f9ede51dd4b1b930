"""Which parameter decides what the hand feels: Sobol indices of every one, by SALib.

The scene is the whole chain from the joint to the hand; each parameter varies by ±30 %, or to
the end of its range. Total-order indices hold what a parameter does alone and together with
others. More points give narrower intervals: ``python sensitivity.py FOLDER 256``.
"""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt
from SALib.analyze import sobol as analyze
from SALib.sample import sobol as sample

import crepitus

SCENE = crepitus.Scene("fig8")
SHARE = 0.3
FELT = ["grating at the hand", "whole torque at the hand", "pitch of the grating"]

Numbers = npt.NDArray[np.float64]


def felt(values: dict[str, float]) -> tuple[float, float, float]:
    """Torque at the hand that changes within 0.1 s (RMS, N·m), all of it (RMS), and Hz."""
    run = crepitus.run(SCENE, set=values)
    steps = round(0.1 / run.scene.step_s)
    torque = run.trace["hand_torque_nm"]
    sums = np.cumsum(torque)
    slow = (sums[steps:] - sums[:-steps]) / steps
    grating = torque[steps // 2 :][: len(slow)] - slow
    second_half = grating[len(grating) // 2 :]
    hand, cycles = run.summary["hand_torque"], run.summary["cycles"]
    return float(second_half.std()), hand["rms_nm"], cycles["frequency_hz"] or 0.0


def bounds() -> dict[str, list[float]]:
    """Lowest and highest value of every parameter of the scene that is not 0."""
    summary = crepitus.run(SCENE, trace=False).summary
    found = {}
    for effect in summary["effects"]:
        for parameter in effect["parameters"]:
            key, value = f"effects.{effect['name']}.{parameter['key']}", parameter["value"]
            if value != 0.0:
                ends = [value * (1 - SHARE), value * (1 + SHARE)]
                refused = crepitus.run_many(SCENE, {key: ends})["failure"]
                # A refused end is beyond the parameter's range.
                found[key] = [value if why else end for end, why in zip(ends, refused)]
    return found


def main(folder: Path, points: int) -> Path:
    ends = bounds()
    problem = {"num_vars": len(ends), "names": list(ends), "bounds": list(ends.values())}
    values: Numbers = sample.sample(problem, points, calc_second_order=False, seed=1)
    with ThreadPoolExecutor() as pool:
        runs = pool.map(felt, [dict(zip(ends, row)) for row in values.tolist()])
        columns: Numbers = np.array(list(runs)).T

    figure, axes = plt.subplots(1, len(FELT), figsize=(9, 6), sharey=True, layout="constrained")
    names = np.array([name.removeprefix("effects.") for name in ends])
    for panel, column, title in zip(axes, columns, FELT):
        found = analyze.analyze(problem, column, calc_second_order=False, seed=1)
        place = np.arange(len(names))
        panel.barh(place, found["ST"], xerr=found["ST_conf"], color="0.6", ecolor="0.2")
        panel.set(title=title, xlabel="total-order index", yticks=place, yticklabels=names)
        strongest = names[np.argmax(found["ST"])]
        print(f"{title}: mostly {strongest}", file=sys.stderr)
    axes[0].invert_yaxis()
    figure.suptitle(f"{len(values)} runs, every parameter ±{SHARE:.0%}")
    file = folder / "sensitivity.svg"
    figure.savefig(file)
    return file


if __name__ == "__main__":
    folder, points = [*sys.argv[1:], *[".", "8"][len(sys.argv) - 1 :]][:2]
    print(main(Path(folder), int(points)))
