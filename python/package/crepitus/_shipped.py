"""What ships."""

from __future__ import annotations

import json
from typing import Any

from . import _crepitus


def scenes() -> dict[str, dict[str, Any]]:
    """The scenes that ship, by name: title, description, duration_s, motion, solver, effects."""
    return _by_name(_crepitus.scenes())


def presets() -> dict[str, dict[str, Any]]:
    """The knees that ship, by name: disorder, severity, what to feel for, evidence, and the
    settings of their effects with units in their names."""
    return _by_name(_crepitus.presets())


def _by_name(text: str) -> dict[str, dict[str, Any]]:
    return {entry["name"]: entry for entry in json.loads(text)}
