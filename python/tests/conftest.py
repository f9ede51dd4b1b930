"""What the tests share: the repository, and the tool to compare with."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

Tool = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="session")
def program() -> Path:
    """The command line tool, which the variable CREPITUS names."""
    name = os.environ.get("CREPITUS")
    if name is None:
        pytest.skip("CREPITUS names no tool to compare with")
    path = (ROOT / name).resolve()
    assert path.is_file(), f"CREPITUS={name}: no such file"
    return path


@pytest.fixture(scope="session")
def tool(program: Path) -> Tool:
    """Runs the tool at the top of the repository."""

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        words = [str(program), *map(str, arguments)]
        return subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=120)

    return run


@pytest.fixture(autouse=True)
def in_repository(monkeypatch: pytest.MonkeyPatch) -> None:
    """Paths in errors are relative to the same folder as the tool's."""
    monkeypatch.chdir(ROOT)
