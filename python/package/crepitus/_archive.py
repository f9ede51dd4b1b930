"""Archives of a study: data, versions, seeds, and an analysis that runs again to the same numbers.

::

    ARCHIVE/
      README.md          what this is, and how it runs again
      study/             every session: protocol, seed, answers, a line a trial
      analysis.py        called as `python analysis.py STUDY RESULTS`
      results/           what it wrote
      versions.json      what `crepitus.provenance()` says
      requirements.txt   libraries, as they were
      SHA256SUMS         of everything above: `sha256sum -c SHA256SUMS`
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _crepitus
from ._provenance import provenance

_SUMS = "SHA256SUMS"

_README = """\
# {title}

{sessions} sessions, by pseudonym, with the analysis that made `results/`.

| what | where |
|---|---|
| each session: protocol, seed, hash of the text of consent, a line a trial | `study/PSEUDONYM/SESSION/` |
| the analysis, `python analysis.py study OUT` | `analysis.py` |
| what it wrote | `results/` |
| versions | `versions.json`, `requirements.txt` |

To run it again, and to compare every file of the results:

    pip install -r requirements.txt     # and crepitus {version}
    python -c "from crepitus import experiments; print(experiments.rerun('.'))"

{descriptions}
"""


@dataclass(frozen=True)
class Rerun:
    """Comparison of an archive's results with those of its analysis, run again.

    Attributes:
        same: Files of the results with the same bytes.
        different: Files with other bytes, and files that only one of both has.
        versions: Versions that differ, by name: then and now.
    """

    same: list[str]
    different: list[str]
    versions: dict[str, tuple[str, str]]

    @property
    def is_same(self) -> bool:
        """Whether every file came out the same."""
        return not self.different


def archive(study: str, to: str | os.PathLike[str], analysis: str | os.PathLike[str], descriptions: bool) -> Path:
    """See :meth:`crepitus.experiments.Study.archive`."""
    target, script = Path(to), Path(analysis)
    code = script.read_bytes()
    if target.exists():
        raise FileExistsError(f"{target} exists: name a new folder")
    with tempfile.TemporaryDirectory(prefix=".crepitus-", dir=target.absolute().parent) as held:
        new = Path(held) / "archive"
        new.mkdir()
        sessions = _crepitus.experiment_deposit(study, new / "study", descriptions)
        if sessions == 0:
            raise ValueError(f"{study}: no session has begun yet")
        (new / "analysis.py").write_bytes(code)
        _analyse(new, new / "results")
        versions = provenance()
        _write(new / "versions.json", json.dumps(versions, indent=2) + "\n")
        pinned = [f"{name}=={version}\n" for name, version in versions["libraries"].items()]
        _write(new / "requirements.txt", "".join(pinned))
        left_out = "Descriptions in participants' own words are left out." if not descriptions else (
            "Descriptions are participants' own words: read them before you give them away."
        )
        readme = _README.format(
            title=target.name,
            sessions=sessions,
            version=versions["crepitus"]["version"],
            descriptions=left_out,
        )
        _write(new / "README.md", readme)
        sums = [f"{_sha256(new / name)}  {name}\n" for name in _files(new)]
        _write(new / _SUMS, "".join(sums))
        new.rename(target)
    return target


def rerun(folder: str | os.PathLike[str]) -> Rerun:
    """Runs the analysis of an archive again, and compares what it writes with the archive's results.

    Every file is checked first; nothing of the archive is changed.

    Raises:
        ValueError: The folder is no archive, or files were changed, added or removed.
        RuntimeError: The analysis fails.
    """
    kept = Path(folder)
    _check(kept)
    versions = _flat(json.loads((kept / "versions.json").read_text(encoding="utf-8")))
    now = _flat(provenance())
    with tempfile.TemporaryDirectory(prefix="crepitus-") as held:
        copy = Path(held) / "archive"
        shutil.copytree(kept, copy, ignore=shutil.ignore_patterns("results"))
        _analyse(copy, copy / "results")
        then, again = _contents(kept / "results"), _contents(copy / "results")
    names = sorted(then.keys() | again.keys())
    same = [name for name in names if then.get(name) == again.get(name)]
    changed = {
        name: (versions.get(name, "none"), now.get(name, "none"))
        for name in sorted(versions.keys() | now.keys())
        if versions.get(name) != now.get(name)
    }
    return Rerun(same, [name for name in names if name not in same], changed)


def _analyse(folder: Path, results: Path) -> None:
    results.mkdir()
    # Pictures have no day and no random names; an order of sets is the same each time.
    environment = {**os.environ, "PYTHONHASHSEED": "0", "SOURCE_DATE_EPOCH": "0", "MPLBACKEND": "Agg"}
    words = [sys.executable, "analysis.py", "study", "results"]
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"the analysis ended with {done.returncode}:\n{done.stderr.strip()[-2000:]}")
    if not any(results.iterdir()):
        raise RuntimeError("the analysis wrote nothing to its second argument, the folder of the results")


def _flat(versions: dict[str, Any]) -> dict[str, str]:
    """Names with a dot: `libraries.numpy`."""
    flat: dict[str, str] = {}
    for name, value in versions.items():
        if isinstance(value, dict):
            flat |= {f"{name}.{below}": text for below, text in _flat(value).items()}
        else:
            flat[name] = str(value)
    return flat


def _check(folder: Path) -> None:
    try:
        lines = (folder / _SUMS).read_text(encoding="utf-8").splitlines()
    except FileNotFoundError:
        raise ValueError(f"{folder} has no {_SUMS}: name a folder that archive() has written") from None
    expected = {line[66:]: line[:64] for line in lines}
    found = {name: _sha256(folder / name) for name in _files(folder) if name != _SUMS}
    names = sorted(expected.keys() | found.keys())
    wrong = [name for name in names if expected.get(name) != found.get(name)]
    if wrong:
        raise ValueError(f"{folder}: changed, added or removed after it was written: {', '.join(wrong)}")


def _files(folder: Path) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


def _contents(folder: Path) -> dict[str, bytes]:
    return {name: (folder / name).read_bytes() for name in _files(folder)}


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="\n")
