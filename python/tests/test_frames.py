"""Runs and sweeps as tables of other libraries, in notebooks, and as figures."""

from __future__ import annotations

import copy
import json
import sys

import numpy as np
import pytest

import crepitus

TS = "effects.crepitus.static_torque_nm"
KR = "effects.crepitus.stiffness_nm_per_rad"
SHORT = {"duration_s": 0.3}


@pytest.fixture(scope="module")
def run() -> crepitus.Run:
    return crepitus.run("everything", set={"duration_s": 0.2})


@pytest.fixture(scope="module")
def grid() -> crepitus.Sweep:
    return crepitus.sweep("low-speed", {TS: "1.6:4:lin5", KR: "20:200:log3"}, set=SHORT)


def phases(run: crepitus.Run) -> list[str]:
    return [("slip-", "stick", "slip+")[sign + 1] for sign in run.trace["phase"]]


def test_pandas(run: crepitus.Run, grid: crepitus.Sweep) -> None:
    pandas = pytest.importorskip("pandas")
    frame = run.to_pandas()
    assert list(frame.columns) == list(run.trace) and len(frame) == len(run.trace["t_s"])
    assert (frame["torque_nm"].to_numpy() == run.trace["torque_nm"]).all()
    assert list(frame["phase"]) == phases(run) and isinstance(frame["phase"].dtype, pandas.CategoricalDtype)
    assert frame.attrs["units"]["torque_nm"] == "N·m" and frame.attrs["units"]["omega_rad_s"] == "rad/s"
    assert frame.attrs["crepitus_version"] == crepitus.__version__
    assert list(run.to_pandas("events")["event"]) == list(run.events["event"])
    rows = grid.to_pandas()
    assert rows.groupby(KR)["torque.rms_nm"].mean().is_monotonic_increasing
    assert rows.attrs["units"][KR] == "N·m/rad"


def test_polars(run: crepitus.Run, grid: crepitus.Sweep) -> None:
    polars = pytest.importorskip("polars")
    frame = run.to_polars()
    assert frame.columns == list(run.trace) and frame["phase"].to_list() == phases(run)
    assert frame["phase"].dtype == polars.Enum(["slip-", "stick", "slip+"])
    assert (frame["torque_nm"].to_numpy() == run.trace["torque_nm"]).all()
    assert run.to_polars("events")["event"].to_list() == list(run.events["event"])
    assert grid.to_polars().filter(polars.col(TS) == 4.0).height == 3
    assert grid.units[TS] == "N·m"


def test_xarray(run: crepitus.Run, grid: crepitus.Sweep) -> None:
    pytest.importorskip("xarray")
    data = run.to_xarray()
    assert data["torque_nm"].dims == ("t_s",) and data["torque_nm"].attrs == {"units": "N·m"}
    assert list(data["phase"].values) == phases(run) and data.attrs["title"] == run.scene.title
    assert data.attrs["scene_sha256"] == crepitus.scene_hash(run.scene)
    near = float(data["torque_nm"].sel(t_s=0.1, method="nearest"))
    assert near == run.trace["torque_nm"][np.argmin(abs(run.trace["t_s"] - 0.1))]
    rows = grid.to_xarray()
    assert rows["torque.rms_nm"].dims == (TS, KR) and rows["torque.rms_nm"].shape == (5, 3)
    assert (rows["torque.rms_nm"].values.ravel() == grid["torque.rms_nm"]).all()
    assert rows[TS].attrs["units"] == "N·m"
    drawn = crepitus.sweep("low-speed", {TS: "1.6:4", KR: "20:200:log"}, latin=5, set=SHORT).to_xarray()
    assert drawn["torque.rms_nm"].dims == ("index",) and drawn[TS].dims == ("index",)
    assert run.to_xarray("events")["event"].dims == ("t_s",)


@pytest.mark.parametrize("module", ["pandas", "polars", "xarray"])
def test_a_library_that_is_missing_is_named(run: crepitus.Run, monkeypatch: pytest.MonkeyPatch, module: str) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=f"pip install {module}"):
        getattr(run, f"to_{module}")()


def test_every_column_has_a_unit_or_needs_none(run: crepitus.Run, grid: crepitus.Sweep) -> None:
    without = {name for name in [*run.trace, *run.events] if name not in run.units}
    assert without == {"phase", "effect", "event", "encoder_count"}, without
    rows = crepitus.run_many("everything", {"duration_s": [0.1]})
    numbers = [name for name, column in {**grid, **rows}.items() if column.dtype.kind == "f"]
    bare = {name.rsplit(".", 1)[-1] for name in numbers if name not in {**grid.units, **rows.units}}
    assert bare == {
        "damping_ratio", "gain", "gear_ratio", "lines", "load_loss", "palm_factor", "residual_relative", "share",
    }, bare


def test_units_are_those_of_the_parameters() -> None:
    from crepitus import _frames

    turns = ("", "1", "lines per motor turn", "motor turns per joint turn")
    for name, parameter in crepitus.parameters().items():
        unit = parameter["unit"] or ""
        assert (_frames.unit(name) or "") == ("" if unit in turns else unit), name


def test_equality_of_runs(run: crepitus.Run) -> None:
    again = crepitus.run("everything", set={"duration_s": 0.2})
    assert run == again and hash(run) == hash(again) and run != 3
    assert run != crepitus.run("everything", set={"duration_s": 0.1})
    assert run != crepitus.run("everything", set={"duration_s": 0.2}, trace=False)
    other = copy.deepcopy(again)
    other.trace["torque_nm"][7] = np.nextafter(other.trace["torque_nm"][7], 9.0)
    assert run != other
    plain = crepitus.run("low-speed", set=SHORT)
    timed = crepitus.run("low-speed", set=SHORT, costs=True)
    assert plain == timed


def test_what_is_there_is_said(run: crepitus.Run) -> None:
    with pytest.raises(ValueError, match="'trace' or 'events'"):
        run.to_pandas("symptoms")
    with pytest.raises(ValueError, match="trace=False"):
        crepitus.run("low-speed", set=SHORT, trace=False).to_pandas()


def test_a_notebook_shows_them(run: crepitus.Run, grid: crepitus.Sweep) -> None:
    for shown, words in [
        (run._repr_html_(), ["Run: ", "N·m", "exact"]),
        (grid._repr_html_(), ["Sweep: ", TS, "15 of 15 runs"]),
        (run.scene._repr_html_(), ["Scene: ", "[effects.crepitus]"]),
    ]:
        assert all(word in shown for word in words)
        assert shown.count("<table>") == shown.count("</table>") == 1
    evil = crepitus.Scene("low-speed").set("title", "<script>alert(1)</script>")
    assert "<script>" not in evil._repr_html_() + crepitus.run(evil, set={"duration_s": 0.01})._repr_html_()


def test_figures(run: crepitus.Run, grid: crepitus.Sweep) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    loud = crepitus.run("high-speed", set=SHORT)
    ax = loud.plot(events=True)
    assert ax.get_xlabel() == "time, s" and ax.get_ylabel() == "torque, N·m"
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["break", "stick"]
    assert run.plot(events=True).get_legend() is None
    figure, given = pyplot.subplots()
    assert run.plot("angle_rad", events=True, ax=given) is given
    assert given.get_xlabel() == "angle, rad"
    with pytest.raises(ValueError, match="no column 'torque'"):
        run.plot(y="torque")
    assert len(grid.plot().collections) == 1
    lines = crepitus.sweep("low-speed", {"solver.kind": ["exact", "exact-events"], TS: "1.6:4:lin5"}, set=SHORT)
    assert len(lines.plot("torque.max_nm").lines) == 2
    drawn = crepitus.sweep("low-speed", {TS: "1.6:4", KR: "20:200:log"}, sobol=8, set=SHORT)
    assert len(drawn.plot().collections) == 1
    with pytest.raises(ValueError, match="one or two varied numbers"):
        crepitus.sweep("low-speed", {"solver.kind": ["exact"]}, set=SHORT).plot()
    pyplot.close("all")


def test_provenance_is_json_and_names_what_made_a_result(run: crepitus.Run, grid: crepitus.Sweep) -> None:
    bare = crepitus.provenance()
    assert bare["crepitus"]["version"] == crepitus.__version__
    assert bare["crepitus"]["target"] and bare["crepitus"]["rustc"].startswith("rustc ")
    assert bare["libraries"]["numpy"] == np.__version__
    assert bare["crepitus"]["commit"] == run.summary["crepitus_commit"]
    of_run, of_sweep = crepitus.provenance(run), crepitus.provenance(grid)
    assert of_run["scene"]["sha256"] == crepitus.scene_hash(run.scene)
    assert of_sweep["sweep"]["varied"] == [TS, KR] and of_sweep["sweep"]["runs"] == 15
    assert crepitus.provenance("low-speed")["scene"]["title"] == crepitus.Scene("low-speed").title
    for each in (bare, of_run, of_sweep):
        assert json.loads(json.dumps(each)) == each
