"""A joint with crepitus: simulations, studies and devices, as NumPy arrays.

>>> import crepitus
>>> run = crepitus.run("slow-examination", set={"duration_s": 1.0})
>>> run.trace["torque_nm"].max()  # N·m
0.4
>>> run.summary["cycles"]["frequency_hz"]
...

==============================  ======================================================================
simulate a scene                :func:`run`, :class:`Scene`, :class:`Run`
what ships                      :func:`scenes`, :func:`presets`
the solver without a step       :func:`reference`
many runs of a scene            :func:`run_many`, :func:`sweep`, :class:`Sweep`, :class:`SweepInterrupted`
a sweep's folder                :func:`read_sweep`, :func:`repeat`
what a result was made with     :func:`provenance`, :func:`scene_hash`
what accuracy costs             :func:`accuracy`
what each effect does           :func:`effects`
a joint in a loop of your own   :class:`Joint`, many of them :class:`Joints`, :class:`Passivity`
a plant in a loop of your own   :class:`Plant`
a device, real or simulated     :class:`Device`, :class:`Mark`, :func:`parameters`
recordings                      :func:`read_recording`, :class:`Recording`, :func:`export_parquet`
measures of an examination      :func:`examination`
a model of a measured knee      :func:`fit`, :class:`KneeFit`, :class:`Candidate`, :class:`Estimate`
a brace, by a swinging weight   :func:`identify`, :class:`BraceFit`
measurements that do not tell   :class:`Refusal`
experiments with people         :mod:`crepitus.experiments`
==============================  ======================================================================

Names end in their unit: ``t_s`` is in s, ``angle_rad`` in rad, ``omega_rad_s`` in rad/s,
``torque_nm`` in N·m. The angle grows with flexion; a torque above 0 opposes growing angle.

Crepitus is a research and education prototype, not a medical device.
"""

from . import experiments
from ._crepitus import Scene, __version__
from ._device import (
    Device,
    Info,
    Mark,
    Recording,
    Stream,
    examination,
    export_parquet,
    parameters,
    read_recording,
)
from ._errors import CrepitusError, DeviceError, Refusal, RunError, SceneError
from ._identify import BraceFit, Candidate, Estimate, KneeFit, fit, identify
from ._joint import Joint, Passivity
from ._joints import Joints
from ._plant import Plant
from ._provenance import provenance
from ._run import Run, reference, run, scene_hash
from ._shipped import presets, scenes
from ._studies import accuracy, effects
from ._sweep import Sweep, SweepInterrupted, read_sweep, repeat, run_many, sweep

__all__ = [
    "BraceFit",
    "Candidate",
    "CrepitusError",
    "Device",
    "DeviceError",
    "Estimate",
    "Info",
    "Joint",
    "Joints",
    "KneeFit",
    "Mark",
    "Passivity",
    "Plant",
    "Recording",
    "Refusal",
    "Run",
    "RunError",
    "Scene",
    "SceneError",
    "Stream",
    "Sweep",
    "SweepInterrupted",
    "__version__",
    "accuracy",
    "effects",
    "examination",
    "experiments",
    "export_parquet",
    "fit",
    "identify",
    "parameters",
    "presets",
    "provenance",
    "read_recording",
    "read_sweep",
    "reference",
    "repeat",
    "run",
    "run_many",
    "scene_hash",
    "scenes",
    "sweep",
]
