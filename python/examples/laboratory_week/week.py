"""A laboratory's week, with simulated participants: `python week.py FOLDER` writes its diary as Markdown.

The participants are simulated observers, whose thresholds are known; what the week finds can be compared with them.
"""

from __future__ import annotations

import json
import shutil
import sys
import tomllib
from pathlib import Path

import numpy as np

import crepitus
from crepitus import experiments
from crepitus.experiments import Observer, Study

HERE = Path(__file__).resolve().parent
PARTICIPANTS = 8
SCALE_NM = 0.04


def observers() -> dict[str, Observer]:
    """Participants whose thresholds, N·m, are drawn around 0.1 N·m."""
    random = np.random.default_rng(59)
    thresholds = random.normal(0.1, 0.02, PARTICIPANTS)
    return {f"P{n + 1:02}": Observer(float(t), SCALE_NM, seed=5900 + n) for n, t in enumerate(thresholds)}


def plan() -> None:
    """Monday: how many trials."""
    print("\n## Plan\n")
    print("| repeats of each difference | trials | median width of the interval, N·m | no wider than 0.06 N·m |")
    print("|---|---|---|---|")
    protocol = tomllib.loads((HERE / "torque.toml").read_text(encoding="utf-8"))
    for repeats in (20, 40, 60):
        protocol["threshold"]["constant"]["repeats"] = repeats
        found = experiments.plan(protocol, lambda run: Observer(0.1, SCALE_NM, seed=run), width=0.06, runs=40)
        print(f"| {repeats} | {found.trials:.0f} | {found.width:.3f} | {found.within:.0%} |")
    power = experiments.power_abx(40 * PARTICIPANTS, 0.6)
    print(f"\nA and B, {PARTICIPANTS} participants with 40 trials: power {power:.2f} if 60 % are right.")


def pilot(folder: Path) -> None:
    """Tuesday: the brace renders what the protocol says, and a session survives."""
    print("\n## Pilot\n")
    protocol = tomllib.loads((HERE / "torque.toml").read_text(encoding="utf-8"))
    held = experiments.session(protocol, seed=1)
    trial = held.trial
    assert trial is not None
    print("| interval | stated, N·m | median of the samples of a moving leg, N·m |")
    print("|---|---|---|")
    with crepitus.Device("sim") as device:
        device.zero()
        for number, interval in enumerate(trial.intervals, 1):
            interval.present(device)
            if not device.armed:
                device.arm()
            samples = device.stream(2.0).samples
            is_moving = np.abs(samples["omega_rad_s"]) > 0.3
            felt = float(np.median(np.abs(samples["model_torque_nm"][is_moving])))
            stated = interval.reveal()["values"]["lead-pipe.torque_nm"]
            print(f"| {number} | {stated:.3f} | {felt:.3f} |")
    study = Study(folder / "pilot")
    for limit in (7, 10_000):
        held = study.begin(folder / "torque.toml", "P00", consented=True)
        print(f"\n{'The session goes on' if held.goes_on else 'A session begins'} with trial {len(held.rows['trial']) + 1}.")
        for trial in held:
            if trial.number > limit:
                # The program ends here: its folder has seven answers.
                break
            held.answer(Observer(0.1, SCALE_NM, seed=trial.number).choose(trial))
        del held


def run(folder: Path) -> Study:
    """Wednesday and Thursday: the participants."""
    print("\n## Run\n")
    study = Study(folder / "study")
    for name, observer in observers().items():
        for protocol in ("torque.toml", "restart.toml"):
            chance = np.random.default_rng(len(name) + ord(name[-1]))
            for trial in (held := study.begin(folder / protocol, name, consented=True)):
                # Nobody feels the rule of restart: they guess.
                is_threshold = protocol == "torque.toml"
                held.answer(observer.choose(trial) if is_threshold else int(chance.integers(1, 3)))
    tables = study.tables()
    print(f"{len(study.participants)} participants, {sum(len(table['trial']) for table in tables)} trials.")
    return study


def analyse(study: Study, folder: Path) -> None:
    """Friday: analysis, figure and archive; then the archive runs again."""
    archive = study.archive(folder / "archive", analysis=HERE / "analysis.py")
    found = json.loads((archive / "results" / "found.json").read_text(encoding="utf-8"))
    torque, restart = found["Difference of torque"], found["Two rules of restart"]
    print("\n## Analyse\n")
    print("| participant | threshold, N·m | 95 % interval | simulated with |")
    print("|---|---|---|---|")
    inside = 0
    for name, observer in observers().items():
        of = torque["participants"][name]
        low, high = of["interval_nm"]
        inside += low <= observer.threshold <= high
        print(f"| {name} | {of['threshold_nm']:.3f} | {low:.3f} to {high:.3f} | {observer.threshold:.3f} |")
    low, high = torque["interval_nm"]
    print(f"\nMean {torque['mean_nm']:.3f} N·m, {low:.3f} to {high:.3f}; {inside} of {PARTICIPANTS} intervals cover.")
    low, high = restart["interval"]
    share = f"{restart['right']} of {restart['trials']} right"
    print(f"\nRules of restart: {share}, {low:.1%} to {high:.1%}, p = {restart['p']:.2f}.")
    print("\n## Archive\n")
    for path in sorted(path.name for path in archive.iterdir()):
        print(f"- `{path}`")
    again = experiments.rerun(archive)
    print(f"\nRun again: {', '.join(again.same)} the same, {len(again.different)} different.")
    shutil.rmtree(folder / "pilot")


def main() -> None:
    """Follows the week in a new folder."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("torque.toml", "restart.toml", "consent.txt"):
        shutil.copy(HERE / name, folder / name)
    print("# A laboratory's week, with simulated participants")
    print("\nMade by `python python/examples/laboratory_week/week.py FOLDER`.")
    plan()
    pilot(folder)
    analyse(run(folder), folder)


if __name__ == "__main__":
    main()
