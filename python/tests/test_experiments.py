"""Experiments with simulated participants: what is found of them is known."""

from __future__ import annotations

import os
import re
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crepitus
from crepitus import experiments
from crepitus.experiments import Observer, Study

from .conftest import ROOT

special = pytest.importorskip("scipy.special")
stats = pytest.importorskip("scipy.stats")

IS_LONG = os.environ.get("CREPITUS_LONG") is not None

CONSTANT = {
    "title": "Torque",
    "threshold": {
        "quantity": "torque",
        "reference": 1.0,
        "constant": {"differences": [0.03, 0.06, 0.1, 0.15, 0.22], "repeats": 40, "catch_trials": 10},
    },
}
STAIRCASES = {
    "title": "Torque",
    "threshold": {
        "quantity": "torque",
        "reference": 1.0,
        "staircase": {
            "rule": "1-up-3-down",
            "start": 0.25,
            "steps": [0.05, 0.02],
            "least": 0.01,
            "most": 0.4,
            "reversals": 40,
            "trials": 100,
            "interleaved": 2,
        },
    },
}
WEIGHTED = {
    "title": "Torque",
    "threshold": {
        "quantity": "torque",
        "staircase": {
            "rule": "weighted",
            "target": 0.75,
            "start": 0.25,
            "steps": [0.02],
            "least": 0.01,
            "most": 0.4,
            "reversals": 200,
            "trials": 200,
        },
    },
}
REALISM = """
title = "Knees of spring"
consent = "consent.txt"
seed = 5
[realism]
presets = ["coarse", "fine", "mas-1-catch", "mas-3-catch", "updrs-2-lead-pipe", "contracture-severe"]
repeats = 2
healthy = 2
features = ["resistance", "end of range"]
"""
TYPES = {
    "coarse": "crepitus",
    "fine": "crepitus",
    "mas-1-catch": "spasticity",
    "mas-3-catch": "spasticity",
    "updrs-2-lead-pipe": "rigidity",
    "contracture-severe": "range-deficit",
    "healthy": "healthy",
}
SEVERITIES = ["none", "mild", "moderate", "severe"]


def answered(held: experiments.Session, choose: Callable[[experiments.Trial], int], most: int = 10_000) -> None:
    for trial in held:
        if trial.number > most:
            break
        held.answer(choose(trial))


def test_a_trial_hides_what_it_is_and_the_order_repeats() -> None:
    held = experiments.session(CONSTANT, seed=3)
    assert held.begun is None and held.protocol["title"] == "Torque"
    trial = held.trial
    assert trial is not None and (trial.number, trial.of, len(trial.intervals)) == (1, 210, 2)
    assert "1.0" not in repr(trial) and "torque" not in repr(trial)
    answered(held, lambda _: 1)
    again = experiments.session(CONSTANT, seed=3)
    answered(again, lambda _: 1)
    for name, column in held.rows.items():
        if name != "unix_s":
            np.testing.assert_array_equal(column, again.rows[name])
    answers, catches = experiments.counts(held.rows)
    # Who always says the first is right in half of the trials.
    assert list(answers["right"]) == [20] * 5 and catches["first"][0] == catches["trials"][0] == 10


def test_what_is_no_answer_is_refused() -> None:
    held = experiments.session(CONSTANT)
    for wrong in (0, 3):
        with pytest.raises(ValueError, match="the interval is"):
            held.answer(wrong)
    with pytest.raises(ValueError, match="number of an interval"):
        held.describe("rough")
    with pytest.raises(RuntimeError, match="trial 1 has no answer"):
        for _ in held:
            pass
    with pytest.raises(ValueError, match="all above 0 or all below"):
        constant = {**CONSTANT["threshold"], "constant": {"differences": [0.1, -0.1], "repeats": 2}}  # type: ignore[dict-item]
        experiments.session({"title": "T", "threshold": constant})
    with pytest.raises(ValueError, match="at most|two levels"):
        experiments.fit_threshold([0.1], [10], [5])
    with pytest.raises(ValueError, match="no more right"):
        experiments.fit_threshold([0.1, 0.2], [10, 10], [5, 11])


@pytest.mark.parametrize("shape", ["gauss", "logistic"])
@pytest.mark.parametrize("protocol", [CONSTANT, STAIRCASES, WEIGHTED], ids=["constant", "staircases", "weighted"])
def test_intervals_cover_the_threshold(protocol: dict[str, Any], shape: str, capsys: pytest.CaptureFixture[str]) -> None:
    runs = 200 if IS_LONG else 6
    scale = 0.04 if shape == "gauss" else 0.025

    def observer(run: int) -> Observer:
        return Observer(0.1, scale, lapse=0.02, shape=shape, seed=1000 + run)

    found = experiments.plan(protocol, observer, width=0.08, runs=runs)
    with capsys.disabled():
        infinite = np.mean([np.isinf(fit.interval).any() for fit in found.fits])
        print(
            f"\n{runs} runs of {found.trials:.0f} trials, {shape}: the interval covers in {100 * found.covered:.1f} %, "
            f"median width {found.width:.4f} of {0.1}, {100 * infinite:.0f} % without an end"
        )
    # Fewer than four of six have a probability of 0.002.
    least, most = (0.91, 0.98) if IS_LONG else (4 / 6, 1.0)
    assert least <= found.covered <= most
    assert abs(np.median([fit.threshold for fit in found.fits]) - 0.1) < (0.01 if IS_LONG else 0.03)
    assert found.width < (0.1 if IS_LONG else 0.15)


def test_the_fit_is_the_best_of_many() -> None:
    """No parameters on a grid are likelier, and the ends of the interval are where the likelihood ratio says."""
    x, n, k = np.array([0.03, 0.06, 0.1, 0.15, 0.22]), np.full(5, 40), np.array([21, 24, 31, 37, 39])
    fit = experiments.fit_threshold(x, n, k)

    constant = stats.binom.logpmf(k, n, 0.5).sum() - n.sum() * np.log(0.5)

    def log_likelihood(m: Any, s: Any, lapse: Any) -> Any:
        p = 0.5 + (0.5 - lapse) * special.ndtr((x - m[..., None]) / s[..., None])
        p = np.minimum(p, 1.0 - 1e-12)
        return constant + (k * np.log(p) + (n - k) * np.log1p(-p)).sum(axis=-1)

    here = log_likelihood(np.array(fit.threshold), np.array(fit.scale), fit.lapse)
    m, s, lapse = np.meshgrid(np.linspace(0.0, 0.25, 126), np.geomspace(0.004, 0.4, 31), np.linspace(0, 0.1, 11))
    grid = log_likelihood(m, s, lapse[..., None])
    assert here - 0.1 < grid.max() <= here + 1e-6
    inside = m[grid > here - stats.chi2.ppf(0.95, 1) / 2]
    assert fit.interval[0] - 1e-4 <= inside.min() < fit.interval[0] + 0.006
    assert fit.interval[1] + 1e-4 >= inside.max() > fit.interval[1] - 0.006
    saturated = stats.binom.logpmf(k, n, k / n).sum()
    assert abs(fit.deviance - 2 * (saturated - here)) < 1e-9
    assert abs(fit.share(fit.at(0.75)) - 0.75) < 1e-12 and np.isnan(fit.at(0.4))


def test_answers_that_bound_nothing_have_an_interval_without_end() -> None:
    fit = experiments.fit_threshold([0.1, 0.2], [20, 20], [20, 20])
    assert fit.interval[0] == -np.inf and fit.interval[1] <= 0.2


def test_the_power_of_a_and_b_is_the_binomial_one() -> None:
    needed = next(k for k in range(41) if stats.binomtest(k, 40, 0.5, alternative="greater").pvalue <= 0.05)
    assert abs(experiments.power_abx(40, 0.7) - stats.binom.sf(needed - 1, 40, 0.7)) < 1e-12
    assert experiments.power_abx(4, 0.9) == 0.0


def study_of(folder: Path) -> Study:
    (folder / "p.toml").write_text(REALISM)
    (folder / "consent.txt").write_text("I agree.")
    return Study(folder / "study")


def rated(study: Study, folder: Path, clinicians: int) -> None:
    """Clinicians who differ in taste, and are not quite sure."""
    random = np.random.default_rng(11)
    real = dict(zip(TYPES, random.uniform(1.5, 4.5, len(TYPES))))
    for number in range(clinicians):
        taste = random.normal(0.0, 0.5)
        held = study.begin(folder / "p.toml", f"C{number}", consented=True)
        for trial in held:
            knee = trial.intervals[0].reveal()["preset"]
            held.describe(f"this is {knee}, I think")
            realism = np.clip(np.rint(real[knee] + taste + random.normal(0.0, 0.6, 3)), 1, 5).astype(int)
            grade = 0 if knee == "healthy" else 1 + int(random.integers(0, 3))
            kind = TYPES[knee] if random.random() < 0.8 else str(random.choice(list(TYPES.values())))
            held.rate([int(x) for x in realism], severity=SEVERITIES[grade], type=kind)


class SplitMix64:
    """The generator of the resamples, written a second time."""

    def __init__(self, seed: int) -> None:
        self.state = seed

    def below(self, n: int) -> int:
        while True:
            self.state = (self.state + 0x9E3779B97F4A7C15) % 2**64
            z = ((self.state ^ (self.state >> 30)) * 0xBF58476D1CE4E5B9) % 2**64
            z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) % 2**64
            z ^= z >> 31
            if z < 2**64 - 2**64 % n:
                return z % n


def interval(units: int, statistic: Callable[[list[int]], float]) -> list[float]:
    """Percentiles of 2,000 resamples of units."""
    random = SplitMix64(1)
    draws = [[random.below(units) for _ in range(units)] for _ in range(2000)]
    found = [statistic(draw) for draw in draws]
    return [float(x) for x in np.percentile([x for x in found if np.isfinite(x)], [2.5, 97.5])]


def agreement(table: Any) -> float:
    """ICC(2,1), by covariances of raters and not by mean squares."""
    covariance = np.cov(table.T)
    k, n = len(covariance), len(table)
    variance = np.trace(covariance) / k
    shared = (covariance.sum() - np.trace(covariance)) / (k * (k - 1))
    between = np.var(table.mean(axis=0), ddof=1) - (variance - shared) / n
    return float(shared / (variance + between)) if table.std() > 0 else np.nan


def consistency(table: Any) -> float:
    """ICC(3,1), by covariances."""
    covariance = np.cov(table.T)
    k = len(covariance)
    shared = (covariance.sum() - np.trace(covariance)) / (k * (k - 1))
    return float(shared / (np.trace(covariance) / k)) if table.std() > 0 else np.nan


def kappa(one: Any, other: Any, weight: Callable[[Any], Any], several: bool) -> float:
    """Kappa by disagreements, as means over all pairs, and not by tables."""
    one, other = np.asarray(one), np.asarray(other)
    if several and len(np.unique(one)) < 2:
        return np.nan
    chance = weight(one[:, None] - other[None, :]).mean()
    return float(1.0 - weight(one - other).mean() / chance) if chance > 0 else np.nan


def test_statistics_are_those_of_other_formulas(tmp_path: Path) -> None:
    study = study_of(tmp_path)
    rated(study, tmp_path, 5)
    (results,), (rows,) = study.results(), study.tables()
    found = results["found"]
    assert (found["clinicians"], found["finished"], found["ratings"]) == (5, 5, 70)
    knees = sorted(set(rows["knee"]) - {"healthy"}) + ["healthy"]
    people = sorted(set(rows["participant"]))
    assert [knee["preset"] for knee in found["knees"]] == knees

    def of(column: str, knee: str, person: str) -> Any:
        return rows[column][(rows["knee"] == knee) & (rows["participant"] == person)].astype(float)

    def close(estimate: dict[str, Any], value: float, limits: list[float]) -> None:
        np.testing.assert_allclose(estimate["value"], value, rtol=0, atol=1e-9)
        np.testing.assert_allclose([estimate["low"], estimate["high"]], limits, rtol=0, atol=1e-9)

    for place, column in enumerate(["realism", "realism: resistance", "realism: end of range"]):
        feature = found["features"][place]
        means = np.array([[of(column, knee, person).mean() for person in people] for knee in knees])
        close(feature["agreement"], agreement(means), interval(7, lambda draw: agreement(means[draw])))
        close(feature["consistency"], consistency(means), interval(7, lambda draw: consistency(means[draw])))
        pairs = np.array([[of(column, knee, person)[:2] for person in people] for knee in knees])
        again = lambda draw: agreement(pairs[draw].reshape(-1, 2))  # noqa: E731
        close(feature["again"], again(list(range(7))), interval(7, again))
        mean = [rows[column][rows["participant"] == person].mean() for person in people]
        close(feature["mean"], float(np.mean(mean)), interval(5, lambda draw: float(np.mean(np.array(mean)[draw]))))
    for knee in found["knees"]:
        each = [of("realism", knee["preset"], person).mean() for person in people]
        close(knee["realism"], float(np.mean(each)), interval(5, lambda draw: float(np.mean(np.array(each)[draw]))))

    grades = np.array([SEVERITIES.index(grade) for grade in rows["severity"]])
    levels = {name: preset["level"] for name, preset in crepitus.presets().items()} | {"healthy": "none"}
    kinds = list(dict.fromkeys(TYPES.values())) + ["other"]
    place_of = np.array([kinds.index(kind) if kind in kinds else len(kinds) for kind in rows["type"]])
    by = {knee: np.flatnonzero(rows["knee"] == knee) for knee in knees}

    def severity(draw: list[int]) -> float:
        chosen = np.concatenate([by[knees[at]] for at in draw])
        meant = [SEVERITIES.index(levels[rows["knee"][row]]) for row in chosen]
        return kappa(meant, grades[chosen], np.abs, True)

    def type_(draw: list[int]) -> float:
        chosen = np.concatenate([by[knees[at]] for at in draw])
        meant = [kinds.index(TYPES[rows["knee"][row]]) for row in chosen]
        return kappa(meant, place_of[chosen], lambda d: (d != 0).astype(float), True)

    def again(draw: list[int]) -> float:
        firsts, seconds = [], []
        for at in draw:
            for person in people:
                own = grades[(rows["knee"] == knees[at]) & (rows["participant"] == person)]
                firsts.append(own[0])
                seconds.append(own[1])
        return kappa(firsts, seconds, np.abs, False)

    whole = list(range(7))
    for name, statistic in (("severity", severity), ("type", type_), ("severity_again", again)):
        close(found[name], statistic(whole), interval(7, statistic))
    is_healthy = rows["knee"] == "healthy"
    assert found["false_alarms"] == [int((rows["type"][is_healthy] != "healthy").sum()), int(is_healthy.sum())]
    assert found["missed"] == [int((rows["type"][~is_healthy] == "healthy").sum()), int((~is_healthy).sum())]


def test_a_and_b_are_those_of_scipy(tmp_path: Path) -> None:
    (tmp_path / "p.toml").write_text('title = "T"\n[abx]\ntrials = 30\na = {}\nb = { preset = "coarse" }\n')
    study = Study(tmp_path / "study")
    random = np.random.default_rng(4)
    for name in ("P1", "P2"):
        held = study.begin(tmp_path / "p.toml", name)
        for trial in held:
            a, _, x = (interval.reveal() for interval in trial.intervals)
            right = 1 if x == a else 2
            held.answer(right if random.random() < 0.7 else 3 - right)
    (results,), (rows,) = study.results(), study.tables()
    right = int(rows["is_right"].sum())
    found = results["found"]["all"]
    expected = stats.binomtest(right, 60, 0.5, alternative="greater").pvalue
    limits = stats.binomtest(right, 60, 0.5).proportion_ci(method="wilson")
    assert found["right"] == right
    np.testing.assert_allclose([found["p"], found["low"], found["high"]], [expected, *limits], rtol=0, atol=1e-9)


KILLED = """
import os, sys
from crepitus.experiments import Study
held = Study(sys.argv[1]).begin(sys.argv[2], "P01")
for trial in held:
    if trial.number > int(sys.argv[3]):
        os.kill(os.getpid(), 9)
    held.answer(1 + trial.number % 2)
"""


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_a_killed_session_goes_on(tmp_path: Path) -> None:
    protocol = tmp_path / "p.toml"
    protocol.write_text(
        'title = "T"\n[threshold]\nquantity = "torque"\n[threshold.staircase]\nrule = "1-up-2-down"\nstart = 0.5\n'
        "steps = [0.1]\nleast = 0.1\nmost = 1.0\nreversals = 8\ntrials = 30\ninterleaved = 2\n"
    )
    words = [sys.executable, "-c", KILLED]
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    for most in (9999,):
        assert subprocess.run([*words, whole, protocol, str(most)]).returncode == 0
    for most in (3, 4, 11, 9999):
        code = subprocess.run([*words, killed, protocol, str(most)]).returncode
        assert code == (0 if most == 9999 else -9)
    (expected,), (found,) = Study(whole).tables(), Study(killed).tables()
    assert len(found["trial"]) > 12
    for name, column in expected.items():
        if name != "unix_s":
            np.testing.assert_array_equal(found[name], column)


def test_participants_are_private_exported_and_deleted(tmp_path: Path) -> None:
    study = study_of(tmp_path)
    with pytest.raises(ValueError, match="consent"):
        study.begin(tmp_path / "p.toml", "C0")
    with pytest.raises(ValueError, match="never a name"):
        study.begin(tmp_path / "p.toml", "Anna", consented=True)
    rated(study, tmp_path, 2)
    assert study.participants == ["C0", "C1"]
    out = tmp_path / "of-C1"
    study.export("C1", out)
    if os.name == "posix":
        for folder in (tmp_path / "study", out):
            for path in [folder, *folder.rglob("*")]:
                mode = stat.S_IMODE(path.stat().st_mode)
                assert mode == (0o700 if path.is_dir() else 0o600), path
    assert study.delete("C1") == 1 and study.participants == ["C0"]
    assert not [path for path in (tmp_path / "study").rglob("*") if "C1" in path.name]
    assert (out / "knees-of-spring-1" / "trials.csv").is_file()
    with pytest.raises(ValueError, match="no participant"):
        study.delete("C1")


def test_the_page_runs(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "experiments.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```python\n(.*?)^```\n", page, re.MULTILINE | re.DOTALL)
    done = subprocess.run([sys.executable, "-c", block], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("Plan(trials=100.0, width=")


def test_a_device_renders_what_a_trial_hides() -> None:
    held = experiments.session(CONSTANT, seed=1)
    trial = held.trial
    assert trial is not None
    with crepitus.Device("sim") as device:
        for interval in trial.intervals:
            interval.present(device)
            wanted = interval.reveal()["values"]["lead-pipe.torque_nm"]
            assert abs(device.get("lead-pipe.torque_nm") - wanted) < 1e-9
            assert device.get("lead-pipe.render") == "on" and device.get("crepitus.render") == "off"
