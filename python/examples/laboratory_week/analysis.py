"""Analysis of the week: `python analysis.py STUDY RESULTS`.

Thresholds by participant and of the group, with 95 % intervals, and whether A and B were told apart.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from scipy import stats  # type: ignore[import-untyped, unused-ignore]

from crepitus import experiments


def rounded(values: Any) -> list[float]:
    """Numbers with the digits that another processor gives, too."""
    return [float(f"{value:.6g}") for value in values]


def thresholds(rows: dict[str, Any], results: Path) -> dict[str, Any]:
    """Fits each participant, draws the functions, and gives the mean of the group."""
    fits = {}
    figure, axes = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
    grid = np.linspace(0.0, 0.25, 126)
    for name in np.unique(rows["participant"]):
        own = {column: values[rows["participant"] == name] for column, values in rows.items()}
        answered, _ = experiments.counts(own)
        fit = fits[str(name)] = experiments.fit_session(own)
        (line,) = axes.plot(grid, fit.share(grid), label=str(name))
        axes.plot(answered["difference"], answered["right"] / answered["trials"], "o", color=line.get_color())
    axes.set(xlabel="difference of torque, N·m", ylabel="share of right answers", ylim=(0.4, 1.02))
    axes.legend()
    figure.savefig(results / "psychometric.svg", metadata={"Date": None})
    found = np.array([fit.threshold for fit in fits.values()])
    low, high = stats.t.interval(0.95, len(found) - 1, found.mean(), stats.sem(found))
    return {
        "participants": {
            name: {"threshold_nm": rounded([fit.threshold])[0], "interval_nm": rounded(fit.interval)}
            for name, fit in fits.items()
        },
        "mean_nm": rounded([found.mean()])[0],
        "interval_nm": rounded([low, high]),
    }


def told_apart(rows: dict[str, Any]) -> dict[str, Any]:
    """Right answers of all, against chance."""
    right, trials = int(rows["is_right"].sum()), len(rows["is_right"])
    test = stats.binomtest(right, trials, 0.5, alternative="greater")
    interval = stats.binomtest(right, trials, 0.5).proportion_ci(method="wilson")
    return {"right": right, "trials": trials, "p": rounded([test.pvalue])[0], "interval": rounded(interval)}


def main() -> None:
    """Analyses the study of the first argument into the folder of the second."""
    study, results = experiments.Study(sys.argv[1]), Path(sys.argv[2])
    plt.rcParams["svg.hashsalt"] = "crepitus"
    found = {}
    for result, rows in zip(study.results(), study.tables()):
        found[result["title"]] = thresholds(rows, results) if "difference" in rows else told_apart(rows)
    (results / "found.json").write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
