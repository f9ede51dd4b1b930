"""Experiments with people: thresholds, A or B, realism.

>>> study = Study("study")
>>> session = study.begin("torque.toml", "P01", consented=True)
>>> for trial in session:
...     ...  # present its intervals, and take an answer
>>> fit_session(session).interval

=================================  ===============================================
participants, and their sessions   :class:`Study`, :class:`Session`, :class:`Trial`
a session in memory                :func:`session`
the psychometric function          :func:`fit_session`, :func:`fit_threshold`, :class:`Fit`
how many trials are needed         :func:`plan`, :func:`power_abx`
a folder to deposit, and again     :meth:`Study.archive`, :func:`rerun`, :class:`Rerun`
participants who are simulated     :class:`Observer`
=================================  ===============================================

Protocols are files: ``crepitus experiment new`` writes one, and the book's page on experiments has every key.
"""

from __future__ import annotations

import csv
import io
import json
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Union

import numpy as np

from . import _archive, _crepitus
from ._archive import Rerun, rerun
from ._device import Device
from ._observer import Observer
from ._psychometric import Fit, fit_threshold, power_abx
from ._types import Columns

__all__ = [
    "Fit",
    "Interval",
    "Observer",
    "Plan",
    "Rerun",
    "Session",
    "Study",
    "Trial",
    "counts",
    "fit_session",
    "fit_threshold",
    "plan",
    "power_abx",
    "rerun",
    "session",
]

#: A protocol: a dict of the keys of its file.
ProtocolDict = Mapping[str, Any]

_WHOLE = {"session", "trial", "staircase", "comparison_in", "answer", "x", "presentation"}
_FLAGS = {"is_right", "has_turned"}
_TEXTS = {"participant", "knee", "description", "severity", "type"}


class Interval:
    """One interval of a trial. It does not show what it is: whoever runs the session stays blind."""

    def __init__(self, stimulus: dict[str, Any]) -> None:
        self._stimulus = stimulus

    def present(self, device: Device) -> int:
        """Renders it on a device, in one commit; returns the new revision."""
        return device._device.present(self._stimulus["preset"], self._stimulus["values"])

    @property
    def device(self) -> str | None:
        """Name of the device that renders it; ``None`` is the one of the session."""
        name: str | None = self._stimulus["device"]
        return name

    def reveal(self) -> dict[str, Any]:
        """Preset and values: for simulated observers, and programs that render by themselves."""
        return dict(self._stimulus)

    def __repr__(self) -> str:
        return "Interval(hidden)"


@dataclass(frozen=True)
class Trial:
    """What is presented next.

    Attributes:
        number: From 1.
        of: Number of all trials; the most of staircases.
        intervals: In the order in which they are presented: two of a threshold, A, B and X, or one knee.
    """

    number: int
    of: int
    intervals: tuple[Interval, ...]


class Session:
    """One participant and one protocol, a trial at a time.

    >>> for trial in session:
    ...     for interval in trial.intervals:
    ...         interval.present(device)
    ...         device.wait(3.0)
    ...     session.answer(int(input("1 or 2? ")))

    A session of a study writes each answer to the disk before the next trial; after a crash
    :meth:`Study.begin` goes on with the trials that would have come.
    """

    def __init__(self, session: _crepitus.Session, goes_on: bool = False) -> None:
        self._session = session
        #: Whether it was interrupted before.
        self.goes_on = goes_on

    @property
    def protocol(self) -> dict[str, Any]:
        """The protocol."""
        protocol: dict[str, Any] = json.loads(self._session.protocol)
        return protocol

    @property
    def begun(self) -> dict[str, Any] | None:
        """Participant, seed, hashes of protocol and consent; ``None`` in memory."""
        begun = self._session.begun
        return None if begun is None else json.loads(begun)

    @property
    def trial(self) -> Trial | None:
        """The current trial; ``None`` if every trial has an answer."""
        text = self._session.trial()
        if text is None:
            return None
        shown = json.loads(text)
        return Trial(shown["number"], shown["of"], tuple(map(Interval, shown["intervals"])))

    def __iter__(self) -> Iterator[Trial]:
        while (trial := self.trial) is not None:
            yield trial
            if (now := self.trial) is not None and now.number == trial.number:
                raise RuntimeError(f"trial {trial.number} has no answer yet: call answer() or rate()")

    def answer(self, choice: int) -> None:
        """Takes a choice, 1 or 2: the interval that has more; of A, B and X, 1 if X is A.

        Raises:
            ValueError: It is no choice of this trial, which stays the current one.
        """
        self._session.choose(choice, time.time())

    @property
    def described(self) -> str | None:
        """Description of the current knee, which waits for its rating; after a crash, too."""
        return self._session.described

    def describe(self, text: str) -> None:
        """Takes what a clinician feels, in his or her own words; :meth:`rate` follows."""
        self._session.describe(text, time.time())

    def rate(self, realism: Sequence[int], *, severity: str, type: str) -> None:
        """Takes the judgement of a knee that was described.

        Args:
            realism: 1 to 5, of the whole and of each feature of the protocol.
            severity: ``none``, ``mild``, ``moderate`` or ``severe``.
            type: ``healthy``, or a disorder such as ``spasticity``.
        """
        self._session.rate(list(realism), severity, type, time.time())

    @property
    def rows(self) -> Columns:
        """The answered trials as columns, a row a trial."""
        header, rows = self._session.rows()
        return _columns(header, rows)


class Study:
    """The folder of a study: participants by pseudonym, readable by this user alone."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = os.fspath(folder)

    def begin(
        self,
        protocol: str | os.PathLike[str],
        participant: str,
        *,
        consented: bool = False,
        seed: int | None = None,
    ) -> Session:
        """Goes on with the participant's last session, or begins one.

        Args:
            protocol: Its TOML file.
            participant: A pseudonym with a digit, such as ``P01``.
            consented: Whether the participant has consented to the protocol's text.
            seed: Of the order; by default it follows from the protocol's, the pseudonym and the session's number.

        Raises:
            ValueError: The protocol or the pseudonym is invalid, or there is no consent.
            OSError: The folder cannot be written.
        """
        session, goes_on = _crepitus.Session.begin(
            self.folder, os.fspath(protocol), participant, seed, consented, int(time.time())
        )
        return Session(session, goes_on)

    @property
    def participants(self) -> list[str]:
        """Pseudonyms."""
        return _crepitus.experiment_participants(self.folder)

    def results(self) -> list[dict[str, Any]]:
        """Results, a dict a protocol: those of ``crepitus experiment results --json``."""
        text, _ = _crepitus.experiment_results(self.folder)
        results: list[dict[str, Any]] = json.loads(text)
        return results

    def tables(self) -> list[Columns]:
        """All trials as columns, a table a protocol, in the order of :meth:`results`."""
        _, tables = _crepitus.experiment_results(self.folder)
        return [_table(text) for text in tables]

    def export(self, participant: str, to: str | os.PathLike[str]) -> None:
        """Copies everything of a participant to a new folder of this user alone."""
        _crepitus.experiment_export(self.folder, participant, os.fspath(to))

    def archive(
        self,
        to: str | os.PathLike[str],
        *,
        analysis: str | os.PathLike[str],
        descriptions: bool = False,
    ) -> Path:
        """Writes a folder that can be deposited: sessions, versions, seeds, the analysis and its results.

        The analysis is run as ``python analysis.py STUDY RESULTS``, in the new folder; :func:`rerun` runs it again and
        compares. Files are this user's alone until you give them away.

        Args:
            to: The new folder.
            analysis: A program, which reads the study of its first argument and writes to the folder of its second.
            descriptions: Whether clinicians' own words stay in; people may be told by them.

        Raises:
            FileExistsError: The folder exists.
            RuntimeError: The analysis fails, with what it said; nothing is written.
            ValueError: No session has begun, or one was changed after it was written.
        """
        return _archive.archive(self.folder, to, analysis, descriptions)

    def delete(self, participant: str, *, force: bool = False) -> int:
        """Removes everything of a participant; returns the number of sessions.

        Files that no session has written are removed with ``force`` only.
        """
        return _crepitus.experiment_delete(self.folder, participant, force)


def session(protocol: ProtocolDict, *, seed: int = 0) -> Session:
    """A session in memory: a pilot, or a simulated observer.

    Raises:
        ValueError: The protocol is invalid.
    """
    return Session(_crepitus.Session.in_memory(json.dumps(protocol), seed))


def counts(rows: Columns) -> tuple[Columns, Columns]:
    """Answers by difference, of the columns of a threshold.

    Returns:
        ``difference``, ``trials`` and ``right`` of the trials with a difference, and of the catch trials
        ``trials`` and ``first``, choices of the first interval.
    """
    is_catch = rows["difference"] == 0.0
    levels = np.unique(rows["difference"][~is_catch])
    of = [rows["is_right"][rows["difference"] == level] for level in levels]
    answered = {
        "difference": levels,
        "trials": np.array([len(each) for each in of], dtype=int),
        "right": np.array([each.sum() for each in of], dtype=int),
    }
    first = (rows["answer"][is_catch] == 1).sum()
    return answered, {"trials": np.array([is_catch.sum()]), "first": np.array([first])}


def fit_session(of: Union[Session, Columns], **options: Any) -> Fit:
    """The psychometric function of a session or of its columns: see :func:`fit_threshold`."""
    answered, _ = counts(of.rows if isinstance(of, Session) else of)
    return fit_threshold(answered["difference"], answered["trials"], answered["right"], **options)


@dataclass(frozen=True)
class Plan:
    """What simulated sessions with a protocol give.

    Attributes:
        trials: Mean number of trials.
        width: Median width of the 95 % interval of the threshold; infinite if half of them have no end.
        within: Share of runs whose interval is no wider than wanted: the power.
        covered: Share of runs whose interval has the true threshold.
        fits: The fits.
    """

    trials: float
    width: float
    within: float
    covered: float
    fits: list[Fit] = field(repr=False)


def plan(
    protocol: ProtocolDict,
    observer: Callable[[int], Observer],
    *,
    width: float,
    runs: int = 100,
) -> Plan:
    """Simulates sessions with a protocol, to choose its number of trials before anybody comes.

    Args:
        protocol: A ``[threshold]``.
        observer: Makes the observer of a run from its number, which is its seed.
        width: The interval that is wanted, in the unit of the quantity.
        runs: Number of sessions.
    """
    fits, counted, covered = [], [], []
    for run in range(runs):
        who = observer(run)
        held = session(protocol, seed=run)
        for trial in held:
            held.answer(who.choose(trial))
        fit = fit_session(held, shape=who.shape)
        low, high = fit.interval
        fits.append(fit)
        counted.append(len(held.rows["trial"]))
        covered.append(low <= who.threshold <= high)
    widths = np.array([fit.interval[1] - fit.interval[0] for fit in fits])
    return Plan(
        trials=float(np.mean(counted)),
        width=float(np.median(widths)),
        within=float(np.mean(widths <= width)),
        covered=float(np.mean(covered)),
        fits=fits,
    )


def _table(text: str) -> Columns:
    header, *rows = csv.reader(io.StringIO(text, newline=""))
    return _columns(header, rows)


def _columns(header: list[str], rows: list[list[str]]) -> Columns:
    return {name: _column(name, [row[place] for row in rows]) for place, name in enumerate(header)}


def _column(name: str, cells: list[str]) -> np.ndarray[Any, Any]:
    if name in _FLAGS:
        return np.array([cell == "true" for cell in cells], dtype=bool)
    if name in _TEXTS:
        return np.array(cells, dtype=str)
    return np.array(cells, dtype=str).astype(int if name in _WHOLE or name.startswith("realism") else float)
