"""What a result was made with."""

from __future__ import annotations

import importlib.metadata
import platform
import sys
from typing import Any, Union

from . import _crepitus
from ._run import Run, scene_hash
from ._run import _scene as checked
from ._sweep import Sweep
from ._types import SceneLike

#: Libraries whose version is named where they are installed.
_LIBRARIES = ("numpy", "scipy", "pandas", "polars", "xarray", "matplotlib")


def provenance(of: Union[SceneLike, Run, Sweep, None] = None) -> dict[str, Any]:
    """What goes beside a result, so that it can be made again: ``json.dump(crepitus.provenance(run), file)``.

    Args:
        of: A run, a sweep, or a scene as for :func:`crepitus.run`.

    Returns:
        ``crepitus``: version, commit (with ``-dirty`` for a changed copy; None if it is not known), target and
        compiler; ``python``, ``platform`` and ``libraries``: versions; ``scene_hash``: how a scene is hashed; and of
        a run or scene its ``scene`` (title, file, sha256) and ``data`` (recording with its SHA-256), of a sweep ``sweep``.
    """
    built = dict(_crepitus.build())
    found: dict[str, Any] = {
        "crepitus": {
            "version": _crepitus.__version__,
            **{name: built.get(name) for name in ("commit", "target", "rustc")},
        },
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        "platform": {
            "system": platform.platform(),
            "machine": platform.machine(),
            "byte_order": sys.byteorder,
        },
        "libraries": {name: version for name in _LIBRARIES if (version := _version(name))},
        "scene_hash": "SHA-256 of Scene.toml in UTF-8 (crepitus.scene_hash)",
    }
    if isinstance(of, Sweep):
        found["sweep"] = {**of.about, "varied": of.varied, "runs": of.runs}
    elif isinstance(of, Run):
        found["scene"] = _scene(of.summary["title"], of.summary["scene"], of.scene)
        if "data" in of.summary:
            found["data"] = of.summary["data"]
    elif of is not None:
        scene = checked(of)
        found["scene"] = _scene(scene.title, scene.file, scene)
    return found


def _scene(title: str, file: str, scene: SceneLike) -> dict[str, str]:
    return {"title": title, "file": file, "sha256": scene_hash(scene)}


def _version(library: str) -> str | None:
    try:
        return importlib.metadata.version(library)
    except importlib.metadata.PackageNotFoundError:
        return None
