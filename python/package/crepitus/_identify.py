"""Models from measurements: the brace, and a knee."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Union

import numpy as np

from . import _crepitus, _html
from ._crepitus import Scene
from ._types import Columns

#: Torque at the joint per ampere of the reference brace, N·m/A.
NM_PER_A = 3.3454


@dataclass(frozen=True)
class Estimate:
    """A value and its 95 % interval.

    Attributes:
        value: In :attr:`unit`; ``None`` if the recording does not show it.
        half_width: Half of the 95 % interval; ``None`` if the value is only known to lie between two strokes, or
            is not shown.
        unit: The unit.
        is_told: Whether the measurements tell the value from others.
        why: Why there is no value; empty if there is one.
    """

    value: float | None
    half_width: float | None
    unit: str
    is_told: bool = True
    why: str = ""

    @property
    def interval(self) -> tuple[float, float] | None:
        """Ends of the 95 % interval."""
        if self.value is None or self.half_width is None:
            return None
        return self.value - self.half_width, self.value + self.half_width


@dataclass(frozen=True)
class Candidate:
    """A model of a measured knee.

    Attributes:
        symptom: Its name.
        effect: The effect of a scene that renders it; ``None`` for a healthy knee.
        muscles: ``flexors`` or ``extensors``.
        values: Parameters by their key in a scene.
        residual_nm: What the fit leaves, N·m rms.
        left_out_nm: Error in strokes that were left out, N·m rms: what models are compared by.
        largest_nm: Largest torque of the symptom, N·m.
    """

    symptom: str
    effect: str | None
    muscles: str
    values: dict[str, Estimate]
    residual_nm: float
    left_out_nm: float
    largest_nm: float


@dataclass(frozen=True)
class KneeFit:
    """A model of a measured knee: numbers to compare with, not a diagnosis.

    Attributes:
        proposed: The model, chosen by the errors in strokes that were left out.
        next: The next one.
        grade: The nearest preset, ``severity``, distance in ``steps``, ``is_far``, ``next``; ``None`` without a symptom.
        friction_nm: Dry friction of limb and apparatus.
        unexplained: ``rms_nm``, its ``share`` of the variance, and ``by_angle``.
        cannot_be_told: Reasons by symptom.
        strokes: Begin, range and speed of each.
        curve: ``t_s``, ``angle_rad``, ``torque_nm``, ``symptom_nm``, ``residual_nm`` of each sample.
        toml: A scene with the fitted knee; :attr:`scene` reads it.
        warnings: How the file was read.
    """

    proposed: Candidate
    next: Candidate
    grade: dict[str, Any] | None
    friction_nm: Estimate
    unexplained: dict[str, Any] = field(repr=False)
    cannot_be_told: dict[str, str] = field(repr=False)
    strokes: list[dict[str, float]] = field(repr=False)
    curve: Columns = field(repr=False)
    toml: str = field(repr=False)
    warnings: list[str]

    @property
    def scene(self) -> Scene:
        """The fitted knee, examined over the same range."""
        return Scene.from_toml(self.toml)

    def _repr_html_(self) -> str:
        return _html.knee(self)


@dataclass(frozen=True)
class BraceFit:
    """Parameters of a brace.

    Attributes:
        values: By their key in a scene, such as ``drivetrain.friction_nm``; one that the recordings do not
            show has a reason instead.
        swings: Number of swings.
        swung_s: Their time, s.
        amplitude_deg: Largest angle, deg.
        residual_deg: What the fit leaves, deg rms.
        notes: What the model does not explain; worth a look before the numbers.
        toml: Tables of a scene.
        warnings: How files were read.
    """

    values: dict[str, Estimate]
    swings: int
    swung_s: float
    amplitude_deg: float
    residual_deg: float
    notes: list[str]
    toml: str = field(repr=False)
    warnings: list[str]

    def _repr_html_(self) -> str:
        return _html.brace(self)


def fit(
    of: Union[str, os.PathLike[str], Mapping[str, Any]],
    *,
    time: str | None = None,
    time_unit: str | None = None,
    angle: str | None = None,
    unit: str | None = None,
    angle_scale: float = 1.0,
    angle_offset: float = 0.0,
    torque: str | None = None,
    torque_unit: str | None = None,
    torque_scale: float = 1.0,
    released_kg_m2: float | None = None,
) -> KneeFit:
    """Fits a model to a measured knee: symptom, grade and parameters of a passive examination.

    Args:
        of: A table such as CSV, a recording of a device, or columns ``t_s``, ``angle_rad`` and ``torque_nm`` (not of
            a released leg). Angles count flexion; a torque is above 0 against flexion.
        time: Column of the times; found by its name if left out.
        time_unit: ``s``, ``ms``, ``us``, ``min`` or ``clock``; that of the file, else s.
        angle: Column of the angles.
        unit: ``deg`` or ``rad``; that of the file or the column's name, else deg.
        angle_scale: Factor of the angles: -1 where they count extension.
        angle_offset: Added to the angles after the factor, deg.
        torque: Column of the torque.
        torque_unit: ``nm``, ``ft-lb`` or ``in-lb``; that of the file or the column's name, else N·m.
        torque_scale: Factor of the torque: -1 where it is above 0 against extension, or the lever of a force, m.
        released_kg_m2: Inertia of a leg that was let go of, kg·m²: no torque is read.

    Raises:
        Refusal: The examination does not tell; the text says why and what to record.
        ValueError: The file has no such columns, or cannot be read.
        KeyboardInterrupt: After Ctrl-C.
    """
    file, arrays = None, None
    if isinstance(of, Mapping):
        names = ["t_s", "angle_rad"] + (["torque_nm"] if released_kg_m2 is None else [])
        missing = [name for name in names if name not in of]
        if missing:
            raise ValueError(f"expected columns {', '.join(names)}: {', '.join(missing)} is missing")
        columns = [_array(name, of[name]) for name in names]
        if len({len(column) for column in columns}) != 1:
            raise ValueError(f"the columns {', '.join(names)} differ in length")
        arrays = (columns[0], columns[1], columns[2] if released_kg_m2 is None else np.empty(0))
    else:
        file = os.fspath(of)
    found, toml, curve = _crepitus.fit(
        file,
        arrays,
        (time, time_unit, angle, unit, float(angle_scale), float(angle_offset)),
        (torque, torque_unit, float(torque_scale), released_kg_m2),
    )
    whole = json.loads(found)
    fitted = whole["fit"]
    names = ["t_s", "angle_rad", "torque_nm", "symptom_nm", "residual_nm"]
    return KneeFit(
        proposed=_candidate(fitted["proposed"]),
        next=_candidate(fitted["next"]),
        grade=fitted["grade"],
        friction_nm=Estimate(fitted["friction_nm"]["value"], fitted["friction_nm"]["half_width"], "N·m"),
        unexplained=fitted["unexplained"],
        cannot_be_told={each["symptom"]: each["why"] for each in fitted["cannot_be_told"]},
        strokes=fitted["strokes"],
        curve={name: np.ascontiguousarray(column) for name, column in zip(names, curve.T)},
        toml=toml,
        warnings=whole["warnings"],
    )


def identify(
    recordings: Union[str, os.PathLike[str], Sequence[Union[str, os.PathLike[str]]]],
    *,
    weight_kg: float,
    lever_m: float,
    weight_inertia_kg_m2: float | None = None,
    weight_tolerance: float = 1.0,
    torque_tolerance: float = 10.0,
    time: str | None = None,
    time_unit: str | None = None,
    angle: str | None = None,
    unit: str | None = None,
    angle_scale: float = 1.0,
    angle_offset: float = 0.0,
    current: str | None = None,
    nm_per_a: float = NM_PER_A,
) -> BraceFit:
    """Identifies a brace from recordings of a known weight that swings in it: friction, inertia, backlash, cuffs.

    Args:
        recordings: Of one weight in one brace: of a device, or tables of time and angle.
        weight_kg: Mass of bar and weight, kg.
        lever_m: Distance of their centre of mass from the axis, m.
        weight_inertia_kg_m2: Their inertia about the axis, kg·m²; mass times the lever's square by default.
        weight_tolerance: 95 % interval of the weight's moment, ± %.
        torque_tolerance: 95 % interval of the motor's torque constant, ± %.
        time, time_unit, angle, unit, angle_scale, angle_offset: Columns of a table, as for :func:`fit`.
        current: Column of the motor's current in a table, A; found by its name if left out.
        nm_per_a: Torque at the joint per ampere, N·m/A, of a table with a current.

    Raises:
        Refusal: The recordings are not those of a weight that swings freely; the text says why.
        ValueError: A file or a number is not usable.
        KeyboardInterrupt: After Ctrl-C.
    """
    files = [recordings] if isinstance(recordings, (str, os.PathLike)) else list(recordings)
    found, toml = _crepitus.identify(
        [os.fspath(file) for file in files],
        (float(weight_kg), float(lever_m), weight_inertia_kg_m2, float(weight_tolerance), float(torque_tolerance)),
        (time, time_unit, angle, unit, float(angle_scale), float(angle_offset)),
        current,
        float(nm_per_a),
    )
    whole = json.loads(found)
    brace = whole["identified"]
    return BraceFit(
        values={
            f"{each['effect']}.{each['key']}": Estimate(
                each["value"],
                each["half_width"],
                each["unit"],
                each["value"] is not None,
                each["not_visible"] or "",
            )
            for each in brace["values"]
        },
        swings=brace["swings"],
        swung_s=brace["swung_s"],
        amplitude_deg=brace["amplitude_deg"],
        residual_deg=brace["residual_deg"],
        notes=brace["notes"],
        toml=toml,
        warnings=whole["warnings"],
    )


def _candidate(of: dict[str, Any]) -> Candidate:
    values = {
        each["key"]: Estimate(each["value"], each["half_width"], each["unit"], each["is_told"]) for each in of["values"]
    }
    rest = {name: value for name, value in of.items() if name != "values"}
    return Candidate(values=values, **rest)


def _array(name: str, values: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim != 1:
        raise ValueError(f"{name}: expected one dimension, got {array.ndim}")
    return array
