"""Friction laws as published, solved by SciPy: the torques in laws.csv.

A second implementation of the laws in sim/ladder/src/laws, by another method: adaptive, implicit or of
high order, on the differential equations of the papers. It shares the rule of the fit (contact.rs) and
no code. Needs SciPy; the test reads laws.csv alone.

    python3 laws.py > laws.csv
"""

from math import exp, pi, sin, sqrt, tanh

from scipy.integrate import solve_ivp

# The paper's joint.
J, KR, TK, TS = 0.01, 400.0, 0.2, 0.4
# Rule of the fit.
VS = 0.3 * (TS - TK) / sqrt(J * KR)
SHARE = 100.0 / 99.0
BODY_J, BODY_K = J * SHARE, KR * SHARE
OBJECT_S0 = 99.0 * BODY_K
OBJECT_S1 = 2.0 * sqrt(OBJECT_S0 * BODY_J)

# To and fro about three break angles, so fast that the Stribeck curve is passed.
AMPLITUDE, HZ, TO_AND_FRO_S = 3.0 * TS / KR, 2.0, 1.0
# Drag of the laws on an object: three cycles of stick and slip.
DRAG, DRAG_S = 0.2, 0.1
POINTS = 100


def stribeck(v):
    return TK + (TS - TK) * exp(-((v / VS) ** 2))


def damping(s1, v):
    """sigma1(v): it falls with the velocity."""
    return s1 / (1.0 + (s1 * v / (2.0 * TK)) ** 2)


def omega(t):
    return AMPLITUDE * 2.0 * pi * HZ * sin(2.0 * pi * HZ * t)


def lugre(s0, v, z):
    return v - s0 * abs(v) / stribeck(v) * z


def dahl(s0, level, v, torque):
    return s0 * v * (1.0 - (torque / level if v >= 0.0 else -torque / level))


def elasto_plastic(s0, v, z):
    z_ss = stribeck(v) / s0
    z_ba, z_max = 0.9 * z_ss, z_ss
    if z * v <= 0.0 or abs(z) <= z_ba:
        alpha = 0.0
    elif abs(z) >= z_max:
        alpha = 1.0
    else:
        alpha = 0.5 + 0.5 * sin(pi * (abs(z) - 0.5 * (z_max + z_ba)) / (z_max - z_ba))
    return v * (1.0 - alpha * abs(z) / z_ss)


def grid(end):
    return [end * (n + 1) / POINTS for n in range(POINTS)]


def to_and_fro(rate, start, torque):
    """Solved anew from each turn of the shaft: the equations have a kink there."""
    turn, y, found = 0.5 / HZ, list(start), []
    for n in range(round(TO_AND_FRO_S / turn)):
        span = (n * turn, (n + 1) * turn)
        times = [t for t in grid(TO_AND_FRO_S) if span[0] < t <= span[1] + 1e-12]
        times = [min(t, span[1]) for t in times]
        # A step no longer than a thousandth: the rate of elasto-plastic has corners.
        solved = solve_ivp(
            lambda t, y: rate(omega(t), y), span, y, "DOP853", times, rtol=1e-11, atol=1e-14, max_step=turn / 1000
        )
        assert solved.success, solved.message
        if not times or times[-1] < span[1]:
            end = solve_ivp(
                lambda t, y: rate(omega(t), y), span, y, "DOP853", rtol=1e-11, atol=1e-14, max_step=turn / 1000
            )
            y = [c[-1] for c in end.y]
        else:
            y = [c[-1] for c in solved.y]
        found += [(t, torque(omega(t), [c[i] for c in solved.y])) for i, t in enumerate(solved.t)]
    return found


def dragged(rate, torque, states):
    """The body begins with the shaft; [theta, theta_dot, states of the law]."""

    def whole(_, y):
        theta, theta_dot, law = y[0], y[1], y[2:]
        w = DRAG - theta_dot
        return [theta_dot, (torque(w, law) - BODY_K * theta) / BODY_J, *rate(w, law)]

    start = [0.0, DRAG] + [0.0] * states
    solved = solve_ivp(whole, (0.0, DRAG_S), start, "Radau", grid(DRAG_S), rtol=1e-10, atol=1e-13, max_step=1e-4)
    assert solved.success, solved.message
    return [(t, torque(DRAG - solved.y[1][i], [c[i] for c in solved.y[2:]])) for i, t in enumerate(solved.t)]


def lugre_torque(s0, s1, v, z):
    return s0 * z + damping(s1, v) * lugre(s0, v, z)


LAWS = {
    "dahl": lambda: to_and_fro(lambda v, y: [dahl(KR, TK, v, y[0])], [0.0], lambda v, y: y[0]),
    "lugre-exponential": lambda: to_and_fro(lambda v, y: [lugre(KR, v, y[0])], [0.0], lambda v, y: KR * y[0]),
    "elasto-plastic": lambda: to_and_fro(lambda v, y: [elasto_plastic(KR, v, y[0])], [0.0], lambda v, y: KR * y[0]),
    "tanh-object": lambda: dragged(lambda w, y: [], lambda w, y: stribeck(w) * tanh(w / (0.1 * VS)), 0),
    "lugre-exponential-object": lambda: dragged(
        lambda w, y: [lugre(OBJECT_S0, w, y[0])], lambda w, y: lugre_torque(OBJECT_S0, OBJECT_S1, w, y[0]), 1
    ),
    "elasto-plastic-object": lambda: dragged(
        lambda w, y: [elasto_plastic(OBJECT_S0, w, y[0])],
        lambda w, y: OBJECT_S0 * y[0] + damping(OBJECT_S1, w) * elasto_plastic(OBJECT_S0, w, y[0]),
        1,
    ),
}

if __name__ == "__main__":
    print("law,t_s,torque_nm")
    for name, solve in LAWS.items():
        for t, torque_nm in solve():
            print(f"{name},{t:.6f},{torque_nm:.9f}")
