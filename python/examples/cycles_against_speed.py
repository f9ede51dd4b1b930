"""Frequency of the cycles against the shaft's speed: simulated, and by the closed form."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import crepitus

SCENE = crepitus.Scene("fig6-ideal-cycle").set("duration_s", 5.0)


def frequencies(speed_rad_s: float) -> dict[str, float]:
    """Frequency of the cycles at a speed, Hz."""
    run = crepitus.run(SCENE, set={"motion.velocity_rad_s": speed_rad_s}, trace=False)
    return {"speed_rad_s": speed_rad_s, "frequency_hz": run.summary["cycles"]["frequency_hz"]}


def closed_form_hz(speed_rad_s: np.ndarray) -> np.ndarray:
    """f = ωn/(2π + 2(λ − atan λ)), λ = (Ts − Tk)/(Ω·√(J·kr)): the book's page on the model."""
    joint = crepitus.presets()["coarse"]["effects"]["crepitus"]
    inertia, stiffness = joint["inertia_kg_m2"], joint["stiffness_nm_per_rad"]
    step = joint["static_torque_nm"] - joint["kinetic_torque_nm"]
    ratio = step / (speed_rad_s * np.sqrt(inertia * stiffness))
    frequency_hz: np.ndarray = np.sqrt(stiffness / inertia) / (
        2 * np.pi + 2 * (ratio - np.arctan(ratio))
    )
    return frequency_hz


def main(folder: Path) -> Path:
    speeds = np.geomspace(0.05, 5.0, 25)
    # Runs release the GIL: threads use all cores.
    with ThreadPoolExecutor() as pool:
        table = pd.DataFrame(list(pool.map(frequencies, speeds.tolist())))
    table["closed_form_hz"] = closed_form_hz(table["speed_rad_s"].to_numpy())
    worst = (table["frequency_hz"] / table["closed_form_hz"] - 1).abs().max()
    assert worst < 1e-9, worst

    figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
    axes.semilogx(table["speed_rad_s"], table["closed_form_hz"], color="0.6", label="closed form")
    axes.semilogx(table["speed_rad_s"], table["frequency_hz"], "o", label="exact-events at 50 µs")
    axes.set(xlabel="speed of the shaft, rad/s", ylabel="cycles a second, Hz")
    axes.legend()
    file = folder / "cycles-against-speed.svg"
    figure.savefig(file)
    return file


if __name__ == "__main__":
    print(main(Path(sys.argv[1] if len(sys.argv) > 1 else ".")))
