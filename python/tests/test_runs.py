"""Runs: whose memory, whose lock, whose Ctrl-C."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import threading
import time
import tracemalloc
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import crepitus

# Minutes of work.
LONG = {"set": {"duration_s": 36_000.0, "solver.step_s": 1e-5}, "trace": False}


def test_arrays_own_what_the_simulator_wrote() -> None:
    tracemalloc.start()
    run = crepitus.run("slow-examination")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    number = run.trace["torque_nm"]
    # Python and NumPy have allocated nothing of that size: the memory is Rust's, and
    # ends with the array, not with the run.
    assert peak < number.nbytes
    assert number.base is not None and not number.flags.owndata
    assert "PySliceContainer" in type(number.base).__name__
    assert number.flags.writeable and number.flags.c_contiguous
    bases = {column.ctypes.data for column in run.trace.values()}
    assert len(bases) == len(run.trace)
    before = number.copy()
    del run
    assert (number == before).all()
    number[:] = 0.0
    assert crepitus.run("slow-examination").trace["torque_nm"].tobytes() == before.tobytes()


def test_columns_are_what_the_names_say() -> None:
    run = crepitus.run("everything", set={"duration_s": 0.5}, trace_every=3)
    assert {len(column) for column in run.trace.values()} == {1_000 // 3 + 1}
    assert run.trace["phase"].dtype == np.int8
    assert all(c.dtype == np.float64 for n, c in run.trace.items() if n.endswith(("_s", "_rad", "_nm")))
    assert set(run.events["event"]) <= {"break", "stick", "reverse"}
    assert run.warnings == run.summary["warnings"]
    assert "rows" in repr(run)


def test_pandas_and_polars_take_it_as_it_is() -> None:
    import pandas
    import polars

    run = crepitus.run("knee-pass-frozen")
    frame = pandas.DataFrame(run.events)
    counts = frame["event"].value_counts()
    assert counts["break"] == run.summary["events"]["break"]
    other = polars.DataFrame(run.trace)
    assert other.height == len(pandas.DataFrame(run.trace))
    assert other["torque_nm"].max() == run.trace["torque_nm"].max()


def test_a_run_agrees_with_the_closed_form() -> None:
    """f = ωn/(2π + 2(λ − atan λ)) at constant speed, which shares nothing with the simulator."""
    inertia, stiffness, kinetic, static, omega = 0.01, 400.0, 0.2, 0.4, 1.3
    natural = math.sqrt(stiffness / inertia)
    ratio = (static - kinetic) / (omega * math.sqrt(inertia * stiffness))
    expected = natural / (2 * math.pi + 2 * (ratio - math.atan(ratio)))
    scene = {
        "version": 1,
        "title": "Constant speed",
        "duration_s": 20.0,
        "motion": {"kind": "constant", "velocity_rad_s": omega},
        "solver": {"kind": "exact-events", "step_s": 5e-5},
        "effects": {"crepitus": {"preset": "coarse"}},
    }
    for run in (crepitus.run(scene), crepitus.reference(scene)):
        assert run.summary["cycles"]["frequency_hz"] == pytest.approx(expected, rel=1e-10)
        breaks = run.events["t_s"][run.events["event"] == "break"]
        assert 1 / np.diff(breaks).mean() == pytest.approx(expected, rel=1e-10)


def test_other_threads_run_meanwhile() -> None:
    counted = 0
    done = threading.Event()

    def count() -> None:
        nonlocal counted
        while not done.is_set():
            counted += 1

    thread = threading.Thread(target=count)
    thread.start()
    try:
        before, begun = counted, time.perf_counter()
        crepitus.run("slow-examination", set={"duration_s": 200.0, "solver.step_s": 1e-5}, trace=False)
        took, passed = time.perf_counter() - begun, counted - before
    finally:
        done.set()
        thread.join()
    # A thread that waits for the lock counts a few times before and after.
    assert took > 0.1 and passed > 20_000 * took, (took, passed)


def test_runs_in_threads_are_the_runs_one_by_one() -> None:
    scenes = [crepitus.Scene("low-speed").set("motion.velocity_rad_s", v) for v in (0.1, 0.2, 0.3, 0.4)]
    with ThreadPoolExecutor(4) as pool:
        parallel = list(pool.map(crepitus.run, scenes))
    for scene, run in zip(scenes, parallel, strict=True):
        assert run.trace["torque_nm"].tobytes() == crepitus.run(scene).trace["torque_nm"].tobytes()


CTRL_C = """
import sys, crepitus
try:
    print("begun", flush=True)
    {work}
except KeyboardInterrupt:
    print("interrupted", flush=True)
    # The interpreter is whole.
    print(len(crepitus.run("knee-pass-frozen").trace["t_s"]) > 0)
"""

WORK = {
    "steps": f"crepitus.run('slow-examination', **{LONG})",
    "plant": "crepitus.run('everything', set={'duration_s': 36000.0}, trace=False)",
    "reference": "crepitus.reference('slow-examination', "
    "set={'duration_s': 9e6, 'output.trace_step_s': 1.0}, trace=False)",
    "accuracy": "crepitus.accuracy(quick=False)",
    "effects": "crepitus.effects(crepitus.Scene('everything').set('duration_s', 1000.0))",
    "joint": "import numpy; j = crepitus.Joint(); z = numpy.full(50_000_000, 5e-5); j.steps(z, z)",
    "device": "d = crepitus.Device('sim', real_time=True); d.zero(); d.arm(); d.wait(60.0)",
}


@pytest.mark.parametrize("work", WORK)
def test_ctrl_c_ends_it(work: str) -> None:
    code = CTRL_C.format(work=WORK[work])
    words = [sys.executable, "-c", code]
    child = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert child.stdout is not None
        assert child.stdout.readline() == "begun\n"
        time.sleep(1.0)
        assert child.poll() is None, child.communicate()
        begun = time.monotonic()
        child.send_signal(signal.SIGINT)
        out, error = child.communicate(timeout=20)
    finally:
        child.kill()
    assert (out, error, child.returncode) == ("interrupted\nTrue\n", "", 0)
    assert time.monotonic() - begun < 5.0


def test_a_handler_may_raise_what_it_likes() -> None:
    class Enough(Exception):
        pass

    def enough(*_: object) -> None:
        raise Enough("of it")

    before = signal.signal(signal.SIGALRM, enough)
    signal.setitimer(signal.ITIMER_REAL, 0.3)
    try:
        with pytest.raises(Enough, match="of it"):
            crepitus.run("slow-examination", **LONG)  # type: ignore[arg-type]
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def test_a_trace_that_does_not_fit_is_refused_before_the_run() -> None:
    with pytest.raises(MemoryError, match="trace_every"):
        crepitus.run("slow-examination", set={"duration_s": 1e6, "solver.step_s": 1e-5})


def test_a_solver_that_diverges_is_an_exception() -> None:
    with pytest.raises(crepitus.RunError, match="diverged"):
        crepitus.run(
            "knee-pass-physical", solver="euler", set={"solver.step_s": 0.05, "duration_s": 5000.0}
        )


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_fork_runs_the_same() -> None:
    expected = crepitus.run("knee-pass-frozen").trace["torque_nm"].tobytes()
    child = os.fork()
    if child == 0:
        same = crepitus.run("knee-pass-frozen").trace["torque_nm"].tobytes() == expected
        os._exit(0 if same else 1)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 0


AT_EXIT = """
import threading, time, crepitus
works = [
    lambda: crepitus.run("slow-examination", set={"duration_s": 36000.0, "solver.step_s": 1e-5}, trace=False),
    lambda: crepitus.Device("sim", real_time=True).wait(60.0),
    lambda: crepitus.run_many("slow-examination", {"duration_s": [1e4] * 100}),
    lambda: crepitus.effects(crepitus.Scene("everything").set("duration_s", 100.0)),
]
for work in works:
    threading.Thread(target=work, daemon=True).start()
time.sleep(0.5)
print("end", flush=True)
"""


def test_the_interpreter_ends_while_threads_work() -> None:
    words = [sys.executable, "-c", AT_EXIT]
    done = subprocess.run(words, capture_output=True, text=True, timeout=20)
    assert (done.stdout, done.stderr, done.returncode) == ("end\n", "", 0)


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="no /proc here")
def test_nothing_leaks() -> None:
    def resident_mb() -> float:
        with open("/proc/self/statm") as statm:
            return int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6

    def work(times: int) -> None:
        for _ in range(times):
            crepitus.run("slow-examination", set={"duration_s": 2.0})
            crepitus.Joint().steps([1e-5] * 1000, [0.2] * 1000)
            with pytest.raises(crepitus.SceneError):
                crepitus.Scene({})
            with crepitus.Device("sim") as device:
                device.stream(0.02)

    work(20)
    before = resident_mb()
    work(100)
    # A leaked trace is 2 MB, a hundred of them 200 MB.
    assert resident_mb() - before < 20.0
