"""The native half: what the package's modules wrap. Use `crepitus`, not this."""

import os
from typing import Any, final

import numpy as np
import numpy.typing as npt

__all__ = [
    "Device",
    "Joint",
    "Joints",
    "Scene",
    "__version__",
    "accuracy",
    "effects",
    "examination",
    "parameters",
    "presets",
    "read_recording",
    "run_design",
    "run_points",
    "scenes",
    "simulate",
]

__version__: str

_Columns = dict[str, npt.NDArray[Any]]

@final
class Scene:
    """Everything that decides a run, checked: motion, solver, effects, output."""

    def __new__(
        cls,
        source: str | os.PathLike[str] | dict[str, Any] | Scene,
        *,
        solver: str | None = None,
        step: float | None = None,
        precision: str | None = None,
        as_device: bool = False,
        set: dict[str, Any] | None = None,
    ) -> Scene:
        """A scene from a file, the name of one that ships, the `summary.json` of a run, a dict or a scene.

        Raises `SceneError` with file, line, key and message."""

    @classmethod
    def from_toml(cls, text: str, file: str | os.PathLike[str] | None = None) -> Scene:
        """A scene from TOML text; `file` names it in errors, and is where paths in it begin."""

    def with_(
        self,
        *,
        solver: str | None = None,
        step: float | None = None,
        precision: str | None = None,
        as_device: bool = False,
        set: dict[str, Any] | None = None,
    ) -> Scene:
        """Another scene: another solver, step (s) or precision, or values at keys."""

    def set(self, key: str, value: object) -> Scene:
        """Another scene, with this value at a key such as `effects.crepitus.preset`."""

    @property
    def toml(self) -> str:
        """The scene as it runs: changes applied, every default written out."""

    @property
    def file(self) -> str:
        """The file that errors name."""

    @property
    def title(self) -> str: ...
    @property
    def description(self) -> str | None: ...
    @property
    def duration_s(self) -> float: ...
    @property
    def motion(self) -> str: ...
    @property
    def solver(self) -> str: ...
    @property
    def step_s(self) -> float: ...
    @property
    def effects(self) -> list[str]: ...
    @property
    def warnings(self) -> list[str]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @staticmethod
    def _rebuilt(
        file: str | os.PathLike[str],
        text: str,
        is_dict: bool,
        flags: tuple[str | None, str | None, str | None, bool],
        set: list[tuple[str, str]],
    ) -> Scene: ...

@final
class Joint:
    def __new__(cls, scene: Scene, omega_rad_s: float) -> Joint: ...
    def step(self, dphi_rad: float, omega_rad_s: float) -> float:
        """One step; returns the torque, N·m."""

    def steps(
        self, dphi_rad: npt.NDArray[np.float64], omega_rad_s: npt.NDArray[np.float64]
    ) -> _Columns: ...
    def restart(self, torque_nm: float = 0.0, omega_rad_s: float = 0.0) -> None: ...
    def copy(self) -> Joint: ...
    @property
    def torque_nm(self) -> float: ...
    @property
    def phase(self) -> int: ...
    @property
    def theta_rad(self) -> float: ...
    @property
    def theta_dot_rad_s(self) -> float: ...
    @property
    def events(self) -> tuple[int, int, int]: ...

@final
class Joints:
    def __new__(
        cls,
        scene: Scene,
        omega_rad_s: npt.NDArray[np.float64],
        parameters: list[tuple[str, npt.NDArray[np.float64]]],
    ) -> Joints: ...
    def __len__(self) -> int: ...
    def step(
        self,
        dphi_rad: npt.NDArray[np.float64],
        omega_rad_s: npt.NDArray[np.float64],
        of_each: bool,
    ) -> npt.NDArray[np.float64]: ...
    def steps(
        self,
        dphi_rad: npt.NDArray[np.float64],
        omega_rad_s: npt.NDArray[np.float64],
        of_each: bool,
        motion: bool,
        threads: int,
    ) -> _Columns: ...
    def restart(self, joint: int, torque_nm: float, omega_rad_s: float) -> None: ...
    def copy(self) -> Joints: ...
    @property
    def torque_nm(self) -> npt.NDArray[np.float64]: ...
    @property
    def phase(self) -> npt.NDArray[np.int8]: ...
    @property
    def theta_rad(self) -> npt.NDArray[np.float64]: ...
    @property
    def theta_dot_rad_s(self) -> npt.NDArray[np.float64]: ...
    @property
    def events(self) -> list[npt.NDArray[np.uint64]]: ...

@final
class Device:
    def __new__(
        cls, name: str | None, scene: Scene | None, *, real_time: bool, program: str
    ) -> Device: ...
    def close(self) -> None: ...
    @property
    def closed(self) -> bool: ...
    def info(self) -> str: ...
    def parameters(self) -> tuple[int, str]: ...
    def set_parameters(self, values: dict[str, Any]) -> int: ...
    def apply(
        self, what: str | os.PathLike[str] | None, *, scene: Scene | None, add: bool
    ) -> int: ...
    def reset(self, groups: list[str]) -> int: ...
    def save(self) -> None: ...
    def zero(self) -> None: ...
    def arm(self) -> None: ...
    def disarm(self) -> None: ...
    def stop(self) -> None: ...
    def clear_fault(self) -> None: ...
    @property
    def armed(self) -> bool: ...
    def wait(self, seconds: float) -> None: ...
    def stream(self, seconds: float, every: int) -> tuple[_Columns, str]: ...
    def record(self, file: str | os.PathLike[str], seconds: float, title: str) -> str | None: ...

def simulate(
    scene: Scene, *, trace: bool, trace_every: int, costs: bool
) -> tuple[_Columns | None, _Columns, str]: ...
def run_points(
    scene: Scene, points: dict[str, list[Any]], *, threads: int | None
) -> dict[str, Any]: ...
def run_design(
    scene: Scene,
    vary: dict[str, str | list[Any]],
    *,
    latin: int | None,
    sobol: int | None,
    seed: int,
    threads: int | None,
) -> dict[str, Any]: ...
def accuracy(scene: Scene | None, *, steps_s: list[float] | None, quick: bool) -> str: ...
def effects(scene: Scene) -> str: ...
def examination(samples: npt.NDArray[np.float64]) -> dict[str, float]: ...
def scenes() -> str: ...
def presets() -> str: ...
def parameters() -> str: ...
def read_recording(path: str | os.PathLike[str]) -> tuple[_Columns, str]: ...
