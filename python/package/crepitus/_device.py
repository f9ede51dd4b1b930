"""Devices: the brace, or its simulation."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any, NamedTuple

import numpy as np

from . import _crepitus
from ._crepitus import Scene
from ._run import _scene, _whole
from ._types import Columns, SceneLike

#: What :meth:`Device.info` returns.
Info = dict[str, Any]


class Mark(NamedTuple):
    """A mark that :meth:`Device.mark` made."""

    #: Its time on the samples' ``t_s``, s.
    t_s: float
    #: Its text.
    text: str


@dataclass(frozen=True)
class Stream:
    """Samples of a device, of a :meth:`Device.stream` or a block of :meth:`Device.blocks`.

    Attributes:
        samples: Columns, a row a sample of 50 µs (or every n-th): ``t_s`` (device time since the connection was made, over
            all streams), ``angle_rad``, ``omega_rad_s``, ``model_torque_nm``, ``torque_nm`` (commanded to the motor),
            ``current_a``, ``phase``, ``limit`` (why the torque is not the model's), …; what was not measured is NaN.
        accounting: Samples ``produced`` = ``received`` + ``dropped``; of the latter ``by_device``; of blocks, so far.
        marks: Marks since the stream or block before.
        zero_unix_s: Unix time at which ``t_s`` was zero, s.
    """

    samples: Columns = field(repr=False)
    accounting: dict[str, int]
    marks: tuple[Mark, ...] = ()
    zero_unix_s: float = float("nan")


@dataclass(frozen=True)
class Recording:
    """A recording of a device: its samples as in :class:`Stream`, and what it says of them.

    Attributes:
        samples: Columns, a row a sample.
        accounting: ``totals``, ``segments``, ``gaps``.
        metadata: Title, versions and serial numbers of the device.
        complete: Whether it was ended in order.
        warnings: What may be wrong with it.
    """

    samples: Columns = field(repr=False)
    accounting: dict[str, Any] = field(repr=False)
    metadata: dict[str, Any]
    complete: bool
    warnings: list[str]


def read_recording(path: str | os.PathLike[str]) -> Recording:
    """Reads a recording that :meth:`Device.record` or ``crepitus record`` wrote, and checks every byte.

    Also one that has become a Parquet file, which pandas and polars read by themselves.
    """
    samples, about = _crepitus.read_recording(os.fspath(path))
    about = json.loads(about)
    return Recording(
        samples, about["books"], about["metadata"], about["complete"], about["warnings"]
    )


def export_parquet(
    recording: str | os.PathLike[str], to: str | os.PathLike[str], *, force: bool = False
) -> int:
    """Writes a recording as a Parquet file, with title, devices and parameters as its metadata.

    Args:
        recording: The file of a recording.
        to: The new file.
        force: Replace a file of that name.

    Returns:
        The number of its rows.
    """
    return _crepitus.export_parquet(os.fspath(recording), os.fspath(to), bool(force))


def examination(of: Recording | Stream) -> dict[str, float]:
    """Measures of an examination, of the samples with the motor on; NaN where there is none.

    They are those of the panel and of ``crepitus report``, with the model's torque: ``range_deg``,
    ``flexion_deg``, ``deficit_deg``, ``peak_speed_deg_s``, ``catch_deg`` (R1), ``slow_end_deg`` (R2),
    ``dynamic_deg``, ``beats``, ``beat_rate_hz``, ``unsteadiness_percent``, ``smoothness``.
    """
    is_on = of.samples["limit"] != "not-armed"
    names = ["t_s", "angle_rad", "omega_rad_s", "model_torque_nm"]
    columns = [of.samples[name][is_on].astype(np.float64) for name in names]
    return _crepitus.examination(np.column_stack(columns))


def parameters() -> dict[str, dict[str, Any]]:
    """A device's parameters by name: unit, min, max or choices, default, meaning."""
    return {entry["name"]: entry for entry in json.loads(_crepitus.parameters())}


class Device:
    """A connection to a device, to be used in a ``with`` block: it disarms at the end.

    >>> with Device("sim") as device:
    ...     device.apply("bone-on-bone")
    ...     device.zero()
    ...     device.arm()
    ...     stream = device.stream(2.0)

    **Torque needs your program.** While the device is armed, one of :meth:`stream`, :meth:`record` or
    :meth:`wait` must run: 250 ms without them, and the drive turns torque off. A hung program renders
    nothing; use :meth:`wait` where you would sleep, or a loop over :meth:`blocks`.

    Threads may share a device. Requests take turns, a few ms each, also while another thread streams; streams, recordings and
    waits come one after the other, and :meth:`stop` ends them. After ``fork`` a process has to open its own.
    """

    def __init__(
        self,
        name: str | os.PathLike[str] | None = None,
        scene: SceneLike | None = None,
        *,
        real_time: bool = False,
    ) -> None:
        """Opens a device.

        Args:
            name: A port (``/dev/ttyACM0``), the name of a simulated one from ``crepitus serve-sim``, ``sim``
                (a simulated one in this process), ``emulated`` (the firmware's own images); by default the one that is
                attached.
            scene: For ``sim`` and ``emulated``, what sets its leg and parameters: ``passive-examination``
                by default.
            real_time: Let the time of ``sim`` and ``emulated`` go with the clock on the wall: no faster in a call, and on between
                calls, for up to a minute; so a program that sleeps loses the torque as on a brace. Without it time stands
                still between calls, and the same calls give the same samples.

        Raises:
            DeviceError: There is no such device, or it does not answer.
            SceneError: The scene cannot be read.
        """
        words = " ".join(["python", *sys.argv[:1]])
        self._device = _crepitus.Device(
            None if name is None else os.fspath(name),
            None if scene is None else _scene(scene),
            real_time=bool(real_time),
            program=words,
        )

    def __enter__(self) -> Device:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Disarms and closes the connection; closing again does nothing."""
        self._device.close()

    @property
    def closed(self) -> bool:
        """Whether it is closed."""
        return self._device.closed

    @property
    def armed(self) -> bool:
        """Whether this connection has armed the device, and it still is."""
        return self._device.armed

    def info(self) -> Info:
        """Identities, status, faults, counters, times: as ``crepitus info --json``."""
        info: Info = json.loads(self._device.info())
        return info

    def get(self, name: str | None = None) -> Any:
        """The value of a parameter; without a name all of them by name. See :func:`parameters`."""
        _, text = self._device.parameters()
        values: dict[str, Any] = json.loads(text)
        if name is None:
            return values
        if name not in values:
            raise KeyError(f"{name!r}: crepitus.parameters() lists the parameters")
        return values[name]

    @property
    def revision(self) -> int:
        """Number of the last commit."""
        revision, _ = self._device.parameters()
        return revision

    def set(self, values: Mapping[str, float | str | bool]) -> int:
        """Sets parameters in one commit: all of them take effect between two ticks, or none.

        Args:
            values: By name, such as ``{"crepitus.static_torque_nm": 0.5, "texture.render": "on"}``.

        Returns:
            The new revision.

        Raises:
            ValueError: A name is unknown, or a value out of its range; nothing was set.
        """
        return self._device.set_parameters(dict(values))

    def apply(self, knee: SceneLike, *, add: bool = False) -> int:
        """Applies a preset, a file of one, or the effects of a scene, in one commit.

        Other effects of the knee go off, unless ``add``, which only presets allow. Returns the new revision.
        """
        if isinstance(knee, (Scene, Mapping)):
            return self._device.apply(None, scene=_scene(knee), add=bool(add))
        return self._device.apply(os.fspath(knee), scene=None, add=bool(add))

    def reset(self, *groups: str) -> int:
        """Sets these groups of parameters, such as ``crepitus``, to their defaults; returns the new revision."""
        return self._device.reset(list(groups))

    def save(self) -> None:
        """Saves the parameters for the next start of the device."""
        self._device.save()

    def zero(self) -> None:
        """Sets the angle's zero here: hold the leg straight. Arming needs it."""
        self._device.zero()

    def arm(self) -> None:
        """Tests the enable lines, then turns torque on. Raises :class:`DeviceError` if it is refused."""
        self._device.arm()

    def disarm(self) -> None:
        """Turns torque off."""
        self._device.disarm()

    def stop(self) -> None:
        """Turns torque off at once, whichever program has armed the device, also from another thread."""
        self._device.stop()

    def clear_fault(self) -> None:
        """Clears the faults; refused while a cause persists."""
        self._device.clear_fault()

    def wait(self, seconds: float) -> None:
        """Lets device time pass, and keeps an armed device armed."""
        self._device.wait(seconds)

    def stream(self, seconds: float, *, every: int = 1) -> Stream:
        """Receives samples for this long, s of device time.

        Args:
            seconds: For how long. A simulated device is faster than that.
            every: Keep only every n-th sample, without a filter.

        Raises:
            DeviceError: The connection was lost, or an armed device has disarmed by itself.
            KeyboardInterrupt: After Ctrl-C; the device is disarmed first.
        """
        return _stream(self._device.stream(seconds, _whole("every", every)))

    def blocks(
        self, block_s: float = 0.05, *, seconds: float | None = None, every: int = 1
    ) -> Iterator[Stream]:
        """Receives samples block by block, for a loop that acts on them.

        >>> for block in device.blocks(0.05, seconds=2.0):
        ...     if block.samples["angle_rad"].max() > 1.0:
        ...         device.set({"crepitus.static_torque_nm": 1.0})

        In the loop the device can be set, marked, armed and disarmed; ``break`` and :meth:`stop` end it. An armed device
        needs a block at least every 250 ms.

        Args:
            block_s: Length of a block, s of device time, at least 1 ms. A device that sends nothing yields what there
                is half a second later.
            seconds: For how long; without end if left out.
            every: Keep only every n-th sample, without a filter.

        Raises:
            DeviceError: As of :meth:`stream`; or this thread is in such a loop already.
        """
        left = None if seconds is None else float(seconds)
        blocks = self._device.blocks(float(block_s), left, _whole("every", every))
        return _each(blocks)

    def mark(self, text: str) -> float:
        """Marks this moment in the samples: the next block, or the stream of another thread, has it in ``marks``.

        Returns its time on their ``t_s``, s. A recording has no marks.
        """
        return self._device.mark(text)

    @property
    def zero_unix_s(self) -> float:
        """Unix time at which ``t_s`` was zero, when the connection was made, s."""
        return self._device.zero_unix_s

    def record(
        self,
        file: str | os.PathLike[str],
        seconds: float,
        *,
        title: str = "Recording of a device",
    ) -> dict[str, int] | None:
        """Records every sample to a file, as ``crepitus record`` does; it must not exist.

        Returns the accounting; ``None`` if no sample came, and then there is no file. After an error the file
        holds what came before. Read it with :func:`read_recording` or ``crepitus report``.
        """
        accounting = self._device.record(os.fspath(file), seconds, title)
        return None if accounting is None else json.loads(accounting)

    def __repr__(self) -> str:
        return repr(self._device)


def _stream(received: tuple[Columns, str, list[tuple[float, str]], float]) -> Stream:
    samples, accounting, marks, zero_unix_s = received
    return Stream(samples, json.loads(accounting), tuple(Mark(*mark) for mark in marks), zero_unix_s)


def _each(blocks: _crepitus.Blocks) -> Iterator[Stream]:
    try:
        while (received := blocks.next()) is not None:
            yield _stream(received)
    finally:
        blocks.end()
