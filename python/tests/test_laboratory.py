"""A laboratory's week with simulated participants, and the archive that it leaves."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from crepitus import experiments
from crepitus.experiments import Study

from .conftest import ROOT

pytest.importorskip("scipy.stats")

WEEK = ROOT / "python" / "examples" / "laboratory_week"
DIARY = ROOT / "docs" / "generated" / "laboratory-week.md"

ANALYSIS = """
import json, pathlib, sys
from crepitus.experiments import Study
rows = Study(sys.argv[1]).tables()[0]
(pathlib.Path(sys.argv[2]) / "found.json").write_text(json.dumps({"right": int(rows["is_right"].sum())}))
"""


def test_the_week_is_the_one_in_the_book(tmp_path: Path) -> None:
    words = [sys.executable, "-W", "error", str(WEEK / "week.py"), str(tmp_path / "week")]
    done = subprocess.run(words, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    # To make it again: python python/examples/laboratory_week/week.py FOLDER > docs/generated/laboratory-week.md
    assert done.stdout == DIARY.read_text(encoding="utf-8")
    archive = tmp_path / "week" / "archive"
    checked = subprocess.run(["sha256sum", "--check", "--quiet", "SHA256SUMS"], cwd=archive)
    assert checked.returncode == 0
    found = json.loads((archive / "results" / "found.json").read_text())
    assert len(found["Difference of torque"]["participants"]) == 8


def study_of(folder: Path) -> Study:
    (folder / "p.toml").write_text('title = "T"\n[abx]\ntrials = 8\na = {}\nb = { preset = "coarse" }\n')
    study = Study(folder / "study")
    for trial in (held := study.begin(folder / "p.toml", "P01")):
        held.answer(1 + trial.number % 2)
    return study


def test_an_archive_tells_what_was_changed(tmp_path: Path) -> None:
    study = study_of(tmp_path)
    (tmp_path / "right.py").write_text(ANALYSIS)
    archive = study.archive(tmp_path / "archive", analysis=tmp_path / "right.py")
    # It is a study itself.
    assert Study(archive / "study").tables()[0]["answer"].tolist() == study.tables()[0]["answer"].tolist()
    again = experiments.rerun(archive)
    assert (again.same, again.different, again.versions) == (["found.json"], [], {}) and again.is_same

    table = next((archive / "study").rglob("trials.csv"))
    whole = table.read_bytes()
    table.write_bytes(whole.replace(b"true", b"false", 1))
    (archive / "more.txt").write_text("more")
    with pytest.raises(ValueError, match=r"changed, added or removed.*more\.txt, study/P01/t-1/trials\.csv"):
        experiments.rerun(archive)
    table.write_bytes(whole)
    (archive / "more.txt").unlink()

    # Results that the analysis does not give, with the sums of whoever wrote them.
    results = archive / "results" / "found.json"
    told = json.loads(results.read_text())
    results.write_text(json.dumps({"right": told["right"] + 1}))
    sums = subprocess.run(["sha256sum", results.relative_to(archive)], cwd=archive, capture_output=True, text=True)
    lines = [line for line in (archive / "SHA256SUMS").read_text().splitlines(True) if "found.json" not in line]
    (archive / "SHA256SUMS").write_text("".join(lines) + sums.stdout)
    again = experiments.rerun(archive)
    assert again.different == ["found.json"] and not again.is_same
    with pytest.raises(ValueError, match="no SHA256SUMS"):
        experiments.rerun(tmp_path)


def test_an_archive_that_fails_leaves_nothing(tmp_path: Path) -> None:
    study = study_of(tmp_path)
    cases = [
        ("import sys; sys.exit('no such column')", RuntimeError, "no such column"),
        ("pass", RuntimeError, "wrote nothing"),
    ]
    for code, kind, message in cases:
        (tmp_path / "a.py").write_text(code)
        with pytest.raises(kind, match=message):
            study.archive(tmp_path / "archive", analysis=tmp_path / "a.py")
    with pytest.raises(FileNotFoundError):
        study.archive(tmp_path / "archive", analysis=tmp_path / "none.py")
    with pytest.raises(FileExistsError):
        study.archive(tmp_path / "study", analysis=tmp_path / "a.py")
    with pytest.raises(ValueError, match="no session has begun"):
        (tmp_path / "empty").mkdir()
        (tmp_path / "empty" / "crepitus-study.txt").write_text("")
        Study(tmp_path / "empty").archive(tmp_path / "archive", analysis=tmp_path / "a.py")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.py", "empty", "p.toml", "study"]
