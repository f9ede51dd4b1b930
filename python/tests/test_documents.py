"""The page, its notebook and the examples run as they are written."""

from __future__ import annotations

import importlib.metadata
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import crepitus

from .conftest import ROOT

sys.path.insert(0, str(ROOT / "python"))
import notebook  # noqa: E402
import reference  # noqa: E402

EXAMPLES = sorted((ROOT / "python" / "examples").glob("*.py"))


def run(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    # Without a screen, and without what tests have set up.
    environment = {**os.environ, "MPLBACKEND": "Agg", "MPLCONFIGDIR": str(folder / "mpl")}
    return subprocess.run(
        [sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True, timeout=300
    )


def test_the_page_runs_block_by_block(tmp_path: Path) -> None:
    page = notebook.PAGE.read_text(encoding="utf-8")
    blocks = notebook.blocks(page)
    assert len(blocks) >= 10
    # Every block of Python is one that runs.
    assert page.count("```python") == len(blocks)
    (tmp_path / "page.py").write_text("\n".join(blocks), encoding="utf-8")
    done = run(["-W", "error", "page.py"], tmp_path)
    assert done.returncode == 0, done.stderr
    for figure in ("cycles.svg", "my-knee.svg"):
        assert (tmp_path / figure).stat().st_size > 10_000
    assert "effects.crepitus" in done.stdout and "Monday" in done.stdout


def test_the_reference_is_that_of_the_package() -> None:
    stored = reference.PAGE.read_text(encoding="utf-8")
    assert stored == reference.text(), "make it again: python python/reference.py"
    for name in crepitus.__all__:
        if name != "experiments":
            assert f"\n### {name}\n" in stored, name


def test_the_notebook_is_the_page_and_runs(tmp_path: Path) -> None:
    nbclient = pytest.importorskip("nbclient")
    nbformat = pytest.importorskip("nbformat")
    stored = notebook.NOTEBOOK.read_text(encoding="utf-8")
    page = notebook.PAGE.read_text(encoding="utf-8")
    assert stored == notebook.text(page), "make it again: python python/notebook.py"
    document = nbformat.reads(stored, as_version=4)
    nbformat.validate(document)
    kernel = {"resources": {"metadata": {"path": str(tmp_path)}}, "timeout": 300}
    nbclient.NotebookClient(document, **kernel).execute()
    code = [cell for cell in document.cells if cell.cell_type == "code"]
    assert all(cell.execution_count for cell in code)
    assert (tmp_path / "my-knee.svg").exists()


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.stem)
def test_examples_make_their_figures(example: Path, tmp_path: Path) -> None:
    done = run(["-W", "error", str(example), str(tmp_path)], tmp_path)
    assert done.returncode == 0, done.stderr
    if example.stem == "costs":
        assert done.stdout.count("\n|") >= 8
    else:
        figure = Path(done.stdout.strip())
        assert figure.parent == tmp_path and figure.stat().st_size > 10_000


@pytest.mark.parametrize("what", ["package", "programs"])
def test_types_are_right(what: str, tmp_path: Path) -> None:
    scripts = [ROOT / "python" / f"{name}.py" for name in ("notebook", "reference")]
    week = (ROOT / "python" / "examples" / "laboratory_week").glob("*.py")
    programs = [str(path) for path in [*EXAMPLES, *week, *scripts]]
    checked = ["-p", "crepitus"] if what == "package" else programs
    done = run(["-m", "mypy", "--strict", "--ignore-missing-imports", *checked], tmp_path)
    assert done.returncode == 0, done.stdout


def test_the_stub_is_what_there_is(tmp_path: Path) -> None:
    # Optional libraries have no stubs of their own.
    settings = tmp_path / "mypy.ini"
    settings.write_text("[mypy]\nignore_missing_imports = True\n")
    absent = tmp_path / "absent.txt"
    absent.write_text(r"crepitus\._\w+\.pandas" + "\n")
    words = ["-m", "mypy.stubtest", "crepitus", "--ignore-disjoint-bases", f"--mypy-config-file={settings}"]
    words += [f"--allowlist={absent}"]
    done = run(words, tmp_path)
    assert done.returncode == 0, done.stdout


def test_every_public_name_is_documented() -> None:
    for name in crepitus.__all__:
        thing = getattr(crepitus, name)
        if name == "__version__" or name == "Info":
            continue
        assert thing.__doc__, name
        assert name in (crepitus.__doc__ or "") or name.endswith("Error") or name in ("Stream", "Run")
        for attribute, value in vars(thing).items() if isinstance(thing, type) else ():
            if not attribute.startswith("_") and callable(value):
                assert value.__doc__, f"{name}.{attribute}"


def test_one_version() -> None:
    root = tomllib.loads((ROOT / "Cargo.toml").read_text())
    version = root["workspace"]["package"]["version"]
    assert crepitus.__version__ == version
    assert importlib.metadata.version("crepitus") == version
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {version}\n" in citation
    assert crepitus.run("presliding", trace=False).summary["crepitus_version"] == version


def test_what_the_examples_need_is_pinned() -> None:
    pinned = (ROOT / "python/tests/requirements.txt").read_text()
    assert re.findall(r"^[a-z].*", pinned, re.MULTILINE)
    assert all("==" in line for line in re.findall(r"^[a-z].*", pinned, re.MULTILINE))
