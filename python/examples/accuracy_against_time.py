"""What accuracy costs in time: every solver on one scene, on this computer."""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

import crepitus


def main(folder: Path) -> Path:
    scene = crepitus.Scene("fig6-ideal-cycle").with_(
        set={"duration_s": 2.0, "effects.crepitus.convention": "physical"}
    )
    points = pd.DataFrame(crepitus.accuracy(scene, steps_s=[5e-4, 2e-4, 1e-4, 5e-5, 2e-5]))
    # A point with a wrong event is no point of a work-precision diagram.
    right = points[(points["unmatched"] == 0) & (points["precision"] == "f64")]

    figure, axes = plt.subplots(figsize=(7, 5), layout="constrained")
    for solver, curve in right.groupby("solver"):
        axes.loglog(
            curve["us_per_simulated_s"],
            curve["rms_tick_torque_error_nm"].clip(lower=1e-16),
            "o-",
            label=str(solver),
        )
    axes.set(
        xlabel="CPU time of a simulated second, µs",
        ylabel="RMS error of the torque at the tick, N·m",
    )
    axes.legend(fontsize="small")
    file = folder / "accuracy-against-time.svg"
    figure.savefig(file)
    return file


if __name__ == "__main__":
    print(main(Path(sys.argv[1] if len(sys.argv) > 1 else ".")))
