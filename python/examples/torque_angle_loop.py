"""Torque over angle, as a clinic draws resistance: three knees under the same hand."""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import crepitus

KNEES = ["lead-pipe-examination", "spasticity-tardieu", "clasp-knife-examination"]


def main(folder: Path) -> Path:
    figure, all_axes = plt.subplots(1, len(KNEES), figsize=(11, 4), layout="constrained")
    for axes, name in zip(all_axes, KNEES, strict=True):
        run = crepitus.run(name)
        axes.plot(np.degrees(run.trace["angle_rad"]), run.trace["hand_torque_nm"], linewidth=0.8)
        axes.set(title=name, xlabel="flexion, deg", ylabel="torque at the hand, N·m")
    file = folder / "torque-angle-loop.svg"
    figure.savefig(file)
    return file


if __name__ == "__main__":
    print(main(Path(sys.argv[1] if len(sys.argv) > 1 else ".")))
