"""Types that the modules share."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, TypeAlias, Union

import numpy as np
import numpy.typing as npt

from ._crepitus import Scene

#: Arrays of one length by column name: what pandas and polars take as a table.
Columns: TypeAlias = dict[str, npt.NDArray[Any]]

#: Floating-point numbers, or what NumPy makes them of.
Numbers: TypeAlias = npt.ArrayLike

#: A scene: a path, the name of one that ships, a dict, or a :class:`crepitus.Scene`.
SceneLike: TypeAlias = Union[str, os.PathLike[str], Mapping[str, Any], Scene]


def columns_of(rows: list[dict[str, Any]], texts: tuple[str, ...] = ()) -> Columns:
    """Rows as columns: numbers as float64 with NaN for what is unknown, all else as text.

    ``texts`` names columns that are text also where no row has any.
    """
    names = list(rows[0]) if rows else []
    columns: Columns = {}
    for name in names:
        values = [row[name] for row in rows]
        is_number = all(isinstance(value, (int, float)) or value is None for value in values)
        if is_number and name not in texts:
            is_whole = all(isinstance(value, int) for value in values)
            dtype = np.int64 if is_whole else np.float64
            columns[name] = np.array([np.nan if v is None else v for v in values], dtype)
        else:
            columns[name] = np.array([_text(value) for value in values])
    return columns


def _text(value: Any) -> str:
    if value is None:
        return ""
    return " ".join(value) if isinstance(value, list) else str(value)
