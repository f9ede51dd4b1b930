"""Columns as tables of pandas, polars and xarray, with their units."""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ._types import Columns

if TYPE_CHECKING:
    import pandas
    import polars
    import xarray

#: Names of the phases -1, 0 and +1, as in ``trace.csv``.
PHASES = ("slip-", "stick", "slip+")

#: Units by the ending of a column's name. A test compares them with those of all parameters.
_UNITS = {
    "nms_per_rad": "N·m·s/rad",
    "nm_per_rad2": "N·m/rad²",
    "nm_per_rad": "N·m/rad",
    "nm_per_a": "N·m/A",
    "nm_per_s": "N·m/s",
    "n_per_m": "N/m",
    "n_per_a": "N/A",
    "ns_per_m": "N·s/m",
    "kg_m2": "kg·m²",
    "rad_s2": "rad/s²",
    "rad_s": "rad/s",
    "deg_s": "deg/s",
    "nms": "N·m·s",
    "nm": "N·m",
    "rad": "rad",
    "deg": "deg",
    "hz": "Hz",
    "kg": "kg",
    "mm": "mm",
    "ms": "ms",
    "us": "µs",
    "ns": "ns",
    "ohm": "Ω",
    "joule": "J",
    "j": "J",
    "w": "W",
    "a": "A",
    "v": "V",
    "n": "N",
    "m": "m",
    "s": "s",
    "g": "g",
    "h": "H",
}

_ENDING = re.compile(r"(?:^|_)(" + "|".join(sorted(_UNITS, key=len, reverse=True)) + r")$")


def unit(name: str) -> str | None:
    """Unit of a column by the ending of its name."""
    ending = _ENDING.search(name.rsplit(".", 1)[-1])
    return _UNITS[ending.group(1)] if ending else None


def without_unit(name: str) -> str:
    """Name of a column without the ending that is its unit."""
    return name if unit(name) is None else _ENDING.sub("", name)


def units(columns: Iterable[str]) -> dict[str, str]:
    """Units by column; columns without one are left out."""
    found = {name: unit(name) for name in columns}
    return {name: of for name, of in found.items() if of is not None}


def to_pandas(columns: Columns, about: Mapping[str, Any]) -> pandas.DataFrame:
    """A DataFrame; its ``attrs`` have ``units`` and what the columns are of."""
    library = need("pandas")
    frame: pandas.DataFrame = library.DataFrame(
        {
            name: library.Categorical.from_codes(column + 1, PHASES) if _is_phase(name, column) else column
            for name, column in columns.items()
        }
    )
    frame.attrs = {"units": units(columns), **about}
    return frame


def to_polars(columns: Columns) -> polars.DataFrame:
    """A DataFrame; polars keeps no metadata, so a unit is in the name alone."""
    library = need("polars")
    frame: polars.DataFrame = library.DataFrame(
        {
            name: library.Series(name, words(column), dtype=library.Enum(PHASES)) if _is_phase(name, column) else column
            for name, column in columns.items()
        }
    )
    return frame


def to_xarray(
    columns: Columns, about: Mapping[str, Any], dimension: str, axes: Sequence[str] = ()
) -> xarray.Dataset:
    """A Dataset along ``dimension``, or over the grid of ``axes``; ``units`` is an attribute of each variable."""
    library = need("xarray")
    of = units(columns)
    grid = _grid(columns, axes)
    dims = tuple(axes) if grid else (dimension,)
    shape = tuple(len(values) for values in grid) if grid else (-1,)

    def variable(name: str, column: npt.NDArray[Any], dims: tuple[str, ...]) -> Any:
        values = words(column) if _is_phase(name, column) else column
        attributes = {"units": of[name]} if name in of else {}
        return library.Variable(dims, values, attributes)

    if grid:
        coords = {name: variable(name, values, (name,)) for name, values in zip(axes, grid)}
    else:
        names = [dimension, *axes] if dimension in columns else list(axes)
        coords = {name: variable(name, columns[name], dims) for name in names}
    variables = {
        name: variable(name, column.reshape(shape), dims)
        for name, column in columns.items()
        if name not in coords and not (grid and name == dimension)
    }
    dataset: xarray.Dataset = library.Dataset(variables, coords, dict(about))
    return dataset


def _grid(columns: Columns, axes: Sequence[str]) -> list[npt.NDArray[Any]] | None:
    """Values of each axis, if the rows are every combination of them and the last is the fastest."""
    if not axes or len(next(iter(columns.values()))) == 0:
        return None
    values = [_in_order(columns[axis]) for axis in axes]
    rows = len(columns[axes[0]])
    if rows != np.prod([len(each) for each in values]):
        return None
    every = np.meshgrid(*values, indexing="ij")
    is_grid = all((columns[axis] == each.ravel()).all() for axis, each in zip(axes, every))
    return values if is_grid else None


def _in_order(column: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Different values, in the order in which they first appear."""
    _, first = np.unique(column, return_index=True)
    found: npt.NDArray[Any] = column[np.sort(first)]
    return found


def words(phase: npt.NDArray[Any]) -> npt.NDArray[np.str_]:
    """Phases by name."""
    named: npt.NDArray[np.str_] = np.array(PHASES)[phase + 1]
    return named


def _is_phase(name: str, column: npt.NDArray[Any]) -> bool:
    return name == "phase" and column.dtype.kind == "i"


def same(one: Columns, other: Columns) -> bool:
    """Whether columns have the same names and the same values; NaN is the same as NaN."""
    if one.keys() != other.keys():
        return False
    return all(
        np.array_equal(column, other[name], equal_nan=column.dtype.kind == "f" and other[name].dtype.kind == "f")
        for name, column in one.items()
    )


def need(module: str) -> Any:
    """An optional library."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise ImportError(f"this needs {module}, which is not installed: pip install {module}") from error
