"""What arrives of the grating, at the paper's force sensor and at the hand.

Ripple against the stiffness of the brace's seat on the leg, the share of the gear's friction that
is compensated, and the speed of the motion; the rest is that of the scene ``fig8``.
"""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt

import crepitus

SCENE = crepitus.Scene("fig8")
SPEEDS = [0.05, 0.1, 0.3, 1.0]
STIFFNESSES = [60.0, 120.0, 300.0, 1e3, 2e3, 5e3, 1e4, 2e4, 5e4]
SHARES = [0.0, 0.4, 0.8, 0.9]
PLACES = {"brace_torque_nm": "at the sensor", "hand_torque_nm": "at the hand"}
LEVELS = {5.0: "worth having", 1.0: "imperceptible"}
PAPER = (2e4, 0.8)
SLOW_S = 0.2

Numbers = npt.NDArray[np.float64]


def without_slow_part(torque: Numbers, steps: int) -> Numbers:
    """Takes away (4·mean over T − mean over 2T)/3, T being so many steps: the weight of a leg that moves."""
    sums = np.cumsum(torque)

    def mean(reach: int) -> Numbers:
        return (sums[2 * reach :] - sums[: -2 * reach]) / (2 * reach)

    narrow, wide = mean(steps // 2), mean(steps)
    off = (len(narrow) - len(wide)) // 2
    slow = (4.0 * narrow[off : off + len(wide)] - wide) / 3.0
    fast: Numbers = torque[steps : steps + len(slow)] - slow
    return fast


def ripple(point: tuple[float, float, float]) -> dict[str, float]:
    """RMS of both torques without their slow part, mN·m, in the second half of the run."""
    speed, stiffness, share = point
    values = {
        "motion.velocity_rad_s": speed,
        # No further than a knee bends.
        "duration_s": min(2.0, 1.2 / speed),
        "effects.cuff.stiffness_nm_per_rad": stiffness,
        # The damping ratio of the scene's seat.
        "effects.cuff.damping_nms_per_rad": 10.0 * float(np.sqrt(stiffness / 2e4)),
        "effects.friction-compensation.share": share,
    }
    run = crepitus.run(SCENE, set=values)
    steps = round(SLOW_S / (run.trace["t_s"][1] - run.trace["t_s"][0]))
    found: dict[str, float] = {}
    for place in PLACES:
        fast = without_slow_part(run.trace[place], steps)
        found[place] = 1e3 * float(fast[len(fast) // 2 :].std())
    return found


def main(folder: Path) -> Path:
    points = list(product(SPEEDS, STIFFNESSES, SHARES))
    with ThreadPoolExecutor() as pool:
        ripples = dict(zip(points, pool.map(ripple, points)))

    figure, axes = plt.subplots(
        len(PLACES), len(SPEEDS), figsize=(12, 6), sharex=True, sharey=True, layout="constrained"
    )
    for row, (place, title) in zip(axes, PLACES.items()):
        for panel, speed in zip(row, SPEEDS):
            for share, shade in zip(SHARES, ["0.75", "0.55", "0.0", "0.35"]):
                line = [ripples[speed, stiffness, share][place] for stiffness in STIFFNESSES]
                panel.loglog(STIFFNESSES, line, ".-", color=shade, label=f"{share:.0%} compensated")
            stiffness, share = PAPER
            panel.plot(stiffness, ripples[speed, stiffness, share][place], "o", color="C3", label="Figs. 8 and 9")
            for level, name in LEVELS.items():
                panel.axhline(level, color="C0", linewidth=0.8, linestyle="--")
                panel.annotate(name, (STIFFNESSES[0], level), color="C0", fontsize="small", va="bottom")
            panel.set(title=f"{title}, {speed} rad/s")
    for panel in axes[-1]:
        panel.set(xlabel="seat of the brace, N·m/rad")
    for panel in axes[:, 0]:
        panel.set(ylabel="ripple, mN·m RMS")
    axes[0, 0].legend(fontsize="small")
    file = folder / "transmission.svg"
    figure.savefig(file, metadata={"Date": None})
    return file


if __name__ == "__main__":
    print(main(Path(sys.argv[1] if len(sys.argv) > 1 else ".")))
