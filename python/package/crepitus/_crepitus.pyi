"""The native half: what the package's modules wrap. Use `crepitus`, not this."""

import os
from collections.abc import Callable
from typing import Any, final

import numpy as np
import numpy.typing as npt

__all__ = [
    "Blocks",
    "Device",
    "Joint",
    "Joints",
    "Plant",
    "Scene",
    "Session",
    "__version__",
    "accuracy",
    "build",
    "effects",
    "examination",
    "experiment_delete",
    "experiment_deposit",
    "experiment_export",
    "experiment_participants",
    "experiment_results",
    "export_parquet",
    "fit",
    "identify",
    "parameters",
    "presets",
    "read_recording",
    "read_sweep",
    "repeat",
    "run_design",
    "run_points",
    "scenes",
    "simulate",
]

__version__: str

_Columns = dict[str, npt.NDArray[Any]]
_Received = tuple[_Columns, str, list[tuple[float, str]], float]

#: Threads, folder, whether another sweep in it is replaced, and what is called with the numbers of finished runs
#: and of all.
_Settings = tuple[int | None, str | None, bool, Callable[[int, int], object] | None]

#: Columns of time and angle: time, its unit, angle, its unit, factor and offset of the angle (deg).
_Table = tuple[str | None, str | None, str | None, str | None, float, float]

#: Columns, what sweep it is in JSON, and the exception that ended it early.
_Sweep = tuple[dict[str, Any], str, BaseException | None]

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

    def with_motion(
        self, time_s: npt.NDArray[np.float64], angle_rad: npt.NDArray[np.float64]
    ) -> Scene:
        """Another scene: samples, s and rad, in the place of its motion, for as long as they last."""

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
    def _repr_html_(self) -> str: ...
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
        """One step: the shaft's turn, rad, and its speed at the end, rad/s; returns the torque, N·m.

        Raises `ValueError` for a motion beyond 50 rad/s, which no joint makes."""

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
    @property
    def returned_j(self) -> float: ...
    def passivity(
        self, delay_steps: float
    ) -> tuple[float, float, float | None, float | None]: ...
    def may_push(self, acceleration_rad_s2: float, velocity_step_rad_s: float) -> bool: ...

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
class Plant:
    def __new__(cls, scene: Scene, count: int, *, takes_torque: bool) -> Plant: ...
    def __len__(self) -> int: ...
    def step(
        self,
        hand_nm: npt.NDArray[np.float64] | None,
        motor_nm: npt.NDArray[np.float64] | None,
        ticks: int,
    ) -> _Columns: ...
    def state(self) -> _Columns: ...
    @property
    def time_s(self) -> float: ...
    @property
    def takes_torque(self) -> bool: ...
    def copy(self) -> Plant: ...
    def restore(self, to: Plant) -> None: ...

@final
class Blocks:
    def next(self) -> _Received | None: ...
    def end(self) -> None: ...

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
    def present(self, preset: str, values: dict[str, float]) -> int: ...
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
    def stream(self, seconds: float, every: int) -> _Received: ...
    def blocks(self, block_s: float, seconds: float | None, every: int) -> Blocks: ...
    def mark(self, text: str) -> float: ...
    @property
    def zero_unix_s(self) -> float: ...
    def record(self, file: str | os.PathLike[str], seconds: float, title: str) -> str | None: ...

@final
class Session:
    @staticmethod
    def in_memory(protocol: str, seed: int) -> Session: ...
    @staticmethod
    def begin(
        folder: str | os.PathLike[str],
        protocol: str | os.PathLike[str],
        participant: str,
        seed: int | None,
        has_consented: bool,
        unix_s: int,
    ) -> tuple[Session, bool]: ...
    @property
    def protocol(self) -> str: ...
    @property
    def begun(self) -> str | None: ...
    def trial(self) -> str | None: ...
    @property
    def described(self) -> str | None: ...
    def choose(self, answer: int, unix_s: float) -> None: ...
    def describe(self, text: str, unix_s: float) -> None: ...
    def rate(
        self, realism: list[int], severity_name: str, disorder: str, unix_s: float
    ) -> None: ...
    def rows(self) -> tuple[list[str], list[list[str]]]: ...

def experiment_results(folder: str | os.PathLike[str]) -> tuple[str, list[str]]: ...
def experiment_participants(folder: str | os.PathLike[str]) -> list[str]: ...
def experiment_export(
    folder: str | os.PathLike[str], participant: str, to: str | os.PathLike[str]
) -> None: ...
def experiment_deposit(folder: str | os.PathLike[str], to: str | os.PathLike[str], with_descriptions: bool) -> int: ...
def experiment_delete(folder: str | os.PathLike[str], participant: str, force: bool) -> int: ...
def simulate(
    scene: Scene, *, trace: bool, trace_every: int, costs: bool
) -> tuple[_Columns | None, _Columns, str]: ...
def run_points(
    scene: Scene, points: dict[str, list[Any]], settings: _Settings
) -> _Sweep: ...
def run_design(
    scene: Scene,
    vary: dict[str, str | list[Any]],
    *,
    latin: int | None,
    sobol: int | None,
    seed: int,
    settings: _Settings,
) -> _Sweep: ...
def repeat(
    folder: str | os.PathLike[str], settings: _Settings
) -> tuple[_Sweep, list[str]]: ...
def read_sweep(folder: str | os.PathLike[str]) -> _Sweep: ...
def build() -> list[tuple[str, str]]: ...
def accuracy(scene: Scene | None, *, steps_s: list[float] | None, quick: bool) -> str: ...
def effects(scene: Scene) -> str: ...
def examination(samples: npt.NDArray[np.float64]) -> dict[str, float]: ...
def scenes() -> str: ...
def presets() -> str: ...
def parameters() -> str: ...
def read_recording(path: str | os.PathLike[str]) -> tuple[_Columns, str]: ...
def fit(
    file: str | None,
    arrays: tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.float64]] | None,
    table: _Table,
    torque: tuple[str | None, str | None, float, float | None],
) -> tuple[str, str, npt.NDArray[np.float64]]: ...
def identify(
    files: list[str],
    weight: tuple[float, float, float | None, float, float],
    table: _Table,
    current: str | None,
    nm_per_a: float,
) -> tuple[str, str]: ...
def export_parquet(
    recording: str | os.PathLike[str], to: str | os.PathLike[str], force: bool
) -> int: ...
