#!/usr/bin/env python3
"""SciPy's solve_ivp on the same work; optional: `pip install scipy`, then run it.

Takes the name of a preset, `coarse` if none is given. Prints a table like that of
`cargo run --release`. Each mode is one call with a terminal, directional event and begins at time
zero; samples come from the dense output. The right-hand side is Python: read the times as what a
user of SciPy waits, not as what its algorithms cost.
"""

import math
import sys
import time
import tomllib
from pathlib import Path

import numpy as np
import scipy
from scipy.integrate import solve_ivp

JOINT = sys.argv[1] if len(sys.argv) > 1 else "coarse"
PRESET = Path(__file__).parents[2] / "presets" / f"{JOINT}.toml"
CREPITUS = tomllib.loads(PRESET.read_text(encoding="utf-8"))["effects"]["crepitus"]
KEYS = ("inertia_kg_m2", "stiffness_nm_per_rad", "kinetic_torque_nm", "static_torque_nm")
J, KR, TK, TS = (CREPITUS[key] for key in KEYS)
OMEGA = 1.0
DURATION, RATE, SAMPLES = 10.0, 20_000, 200_000
WN = math.sqrt(KR / J)
LAMBDA = (TS - TK) / (OMEGA * math.sqrt(J * KR))
STICK = 2 * (TS - TK) / (KR * OMEGA)
SLIP = 2 * (math.pi - math.atan(LAMBDA)) / WN
FIRST = TS / (KR * OMEGA)
# State (u, v), u = wn * theta: both of order one, so one tolerance serves both.
UK, US = WN * TK / KR, WN * TS / KR
SAMPLE_TIMES = np.arange(1, SAMPLES + 1) / RATE


def closed_form_events():
    breaks = FIRST + np.arange(int(DURATION / (STICK + SLIP)) + 1) * (STICK + SLIP)
    events = np.sort(np.concatenate([breaks, breaks + SLIP]))
    return events[events <= DURATION]


def closed_form_torque():
    """The torque at each sample; NaN within 1 us of an event."""
    since = SAMPLE_TIMES - FIRST
    in_cycle = np.mod(since, STICK + SLIP)
    torque = np.where(in_cycle < SLIP, TK, 2 * TK - TS + KR * OMEGA * (in_cycle - SLIP))
    torque = np.where(since < 0, KR * OMEGA * SAMPLE_TIMES, torque)
    events = closed_form_events()
    right = np.clip(np.searchsorted(events, SAMPLE_TIMES), 1, len(events) - 1)
    nearest = np.minimum(abs(SAMPLE_TIMES - events[right - 1]), abs(SAMPLE_TIMES - events[right]))
    return np.where(nearest <= 1e-6, np.nan, torque)


def terminal(function):
    function.terminal, function.direction = True, -1
    return function


STICK_MODE = (lambda t, y: (WN * y[1], 0.0), terminal(lambda t, y: US - y[0]))
SLIP_MODE = (lambda t, y: (WN * y[1], WN * (UK - y[0])), terminal(lambda t, y: OMEGA - y[1]))


def run(method, rtol, max_step, samples):
    """Times of the events, and the torque at each sample if asked for."""
    events, torque = [], np.full(SAMPLES, np.nan) if samples else None
    y, begun, slipping, taken = (0.0, OMEGA), 0.0, False, 0
    while True:
        rhs, event = SLIP_MODE if slipping else STICK_MODE
        solution = solve_ivp(
            rhs, (0.0, DURATION - begun), y, method=method, rtol=rtol, atol=rtol, events=event,
            max_step=max_step if slipping else math.inf, dense_output=samples,
        )
        found = solution.status == 1
        until = solution.t_events[0][0] if found else DURATION - begun
        if samples:
            end = SAMPLES if not found else np.searchsorted(SAMPLE_TIMES, begun + until, "right")
            if end > taken:
                u = solution.sol(SAMPLE_TIMES[taken:end] - begun)[0]
                torque[taken:end] = TK if slipping else KR / WN * u
            taken = end
        if not found:
            return np.array(events), torque
        begun += until
        events.append(begun)
        y = (solution.y_events[0][0][0], OMEGA)
        slipping = not slipping


def timed(*args):
    start = time.thread_time()
    result = run(*args)
    return 1e3 * (time.thread_time() - start), *result


def main():
    truth, torque_truth = closed_form_events(), closed_form_torque()
    print(
        f"SciPy {scipy.__version__}, {JOINT}, CPU time of a single run each\n\n"
        f"| solver | setting | events of {len(truth)} | worst event error, s | events only, ms "
        "| all samples, ms | worst torque error, N·m |\n|---|---|---|---|---|---|---|"
    )
    for method in ("RK45", "DOP853", "Radau"):
        for rtol in (1e-6, 1e-9, 1e-12):
            for max_step in (math.inf, STICK / 2):
                label = f"{rtol:.0e}" + ("" if math.isinf(max_step) else ", step limited")
                print(f"{method} {label}", file=sys.stderr)
                ms, events, _ = timed(method, rtol, max_step, False)
                sampled_ms, _, torque = timed(method, rtol, max_step, True)
                complete = len(events) == len(truth)
                error = f"{np.max(np.abs(events - truth)):.1e}" if complete else "–"
                torque_error = np.nanmax(np.abs(torque - torque_truth))
                print(
                    f"| SciPy {method} | {label} | {len(events)} | {error} | {ms:.0f} "
                    f"| {sampled_ms:.0f} | {torque_error:.1e} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
