"""Progress of long work, for people."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any, TypeAlias, Union

#: ``True`` for a bar, or a function that gets the number of finished runs and of all.
Progress: TypeAlias = Union[bool, Callable[[int, int], object]]


#: What stands for a bar where there is no tqdm.
_LINE = object()


class _Bar:
    """A bar of tqdm's where it is installed, in a notebook its widget; else a line on stderr."""

    def __init__(self) -> None:
        self._bar: Any = None

    def __call__(self, done: int, total: int) -> None:
        if self._bar is None:
            self._bar = _tqdm(done, total)
        if self._bar is not _LINE:
            self._bar.update(done - self._bar.n)
        else:
            sys.stderr.write(f"\r{done} of {total} runs")
            sys.stderr.flush()

    def close(self) -> None:
        if self._bar is _LINE:
            sys.stderr.write("\n")
        elif self._bar is not None:
            self._bar.close()


def _tqdm(done: int, total: int) -> Any:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return _LINE
    return tqdm(total=total, initial=done, unit="run")


def reported(progress: Progress) -> tuple[Callable[[int, int], object] | None, Callable[[], None]]:
    """A function that gets progress, if any, and one to call in the end."""
    if progress is True:
        bar = _Bar()
        return bar, bar.close
    if progress is False or progress is None:
        return None, lambda: None
    if not callable(progress):
        raise TypeError(f"progress: expected True, False or a function of (done, total), got {progress!r}")
    return progress, lambda: None
