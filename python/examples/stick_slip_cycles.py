"""The picture of the README: torque and velocities over the first stick-slip cycles."""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt

import crepitus


def main(folder: Path) -> Path:
    run = crepitus.run("slow-examination", set={"duration_s": 0.4})
    trace, events = run.trace, run.events
    breaks = events["event"] == "break"
    sticks = events["event"] == "stick"

    figure, (torque, speed) = plt.subplots(2, sharex=True, figsize=(8, 5), layout="constrained")
    ends = (0.0, 0.5)
    torque.fill_between(
        trace["t_s"], *ends, where=trace["phase"] == 0, color="0.9", step="post", label="stick"
    )
    torque.plot(trace["t_s"], trace["torque_nm"], color="C3", linewidth=1)
    torque.plot(events["t_s"][breaks], events["torque_before_nm"][breaks], "^", color="k", label="break")
    torque.plot(events["t_s"][sticks], events["torque_after_nm"][sticks], "o", color="k", label="stick again")
    torque.set(ylabel="torque, N·m", ylim=ends, xlim=(0.15, 0.35))
    torque.legend(loc="upper left", ncols=3)
    speed.plot(trace["t_s"], trace["theta_dot_rad_s"], color="C0", label="object")
    speed.plot(trace["t_s"], trace["omega_rad_s"], color="k", label="shaft")
    speed.set(xlabel="time, s", ylabel="velocity, rad/s")
    speed.legend(loc="lower left")
    file = folder / "stick-slip-cycles.svg"
    figure.savefig(file)
    return file


if __name__ == "__main__":
    print(main(Path(sys.argv[1] if len(sys.argv) > 1 else ".")))
