"""One pass of a knee under two conventions: grating in one, hardly any in the other."""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import polars as pl

import crepitus


def main(folder: Path) -> Path:
    figure, all_axes = plt.subplots(2, sharex=True, figsize=(8, 5), layout="constrained")
    for axes, convention in zip(all_axes, ["frozen", "physical"], strict=True):
        run = crepitus.run(f"knee-pass-{convention}")
        events = pl.DataFrame(run.events).filter(pl.col("event") == "break")
        interval_s = events["t_s"].diff().drop_nulls().to_numpy()
        axes.plot(run.trace["t_s"], run.trace["torque_nm"], linewidth=0.6)
        axes.set(
            ylabel="torque, N·m",
            title=f"{convention}: {run.summary['events']['break']} breaks, "
            f"{np.median(interval_s):.3f} s from one to the next (median)",
        )
    all_axes[-1].set(xlabel="time, s")
    file = folder / "frozen-and-physical.svg"
    figure.savefig(file)
    return file


if __name__ == "__main__":
    print(main(Path(sys.argv[1] if len(sys.argv) > 1 else ".")))
