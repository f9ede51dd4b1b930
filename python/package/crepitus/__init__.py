"""A joint with crepitus: simulations, studies and devices, as NumPy arrays.

>>> import crepitus
>>> run = crepitus.run("slow-examination", set={"duration_s": 1.0})
>>> run.trace["torque_nm"].max()  # N·m
0.4
>>> run.summary["cycles"]["frequency_hz"]
...

==============================  ==================================================
simulate a scene                :func:`run`, :class:`Scene`, :class:`Run`
what ships                      :func:`scenes`, :func:`presets`
the solver without a step       :func:`reference`
many runs of a scene            :func:`run_many`, :func:`sweep`
what accuracy costs             :func:`accuracy`
what each effect does           :func:`effects`
a joint in a loop of your own   :class:`Joint`, many of them :class:`Joints`
a device, real or simulated     :class:`Device`, :func:`parameters`
recordings                      :func:`read_recording`, :class:`Recording`
measures of an examination      :func:`examination`
==============================  ==================================================

Names end in their unit: ``t_s`` is in s, ``angle_rad`` in rad, ``omega_rad_s`` in rad/s,
``torque_nm`` in N·m. The angle grows with flexion; a torque above 0 opposes growing angle.

Crepitus is a research and education prototype, not a medical device.
"""

from ._crepitus import Scene, __version__
from ._device import Device, Info, Recording, Stream, examination, parameters, read_recording
from ._errors import CrepitusError, DeviceError, RunError, SceneError
from ._joint import Joint
from ._joints import Joints
from ._run import Run, reference, run
from ._shipped import presets, scenes
from ._studies import accuracy, effects
from ._sweep import run_many, sweep

__all__ = [
    "CrepitusError",
    "Device",
    "DeviceError",
    "Info",
    "Joint",
    "Joints",
    "Recording",
    "Run",
    "RunError",
    "Scene",
    "SceneError",
    "Stream",
    "__version__",
    "accuracy",
    "effects",
    "examination",
    "parameters",
    "presets",
    "read_recording",
    "reference",
    "run",
    "run_many",
    "scenes",
    "sweep",
]
