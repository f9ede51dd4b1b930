#!/usr/bin/env python3
"""Reference solutions of the stick-slip friction model, event by event, with 50 digits.

An imaginary object (inertia J on a spring kr with damping c) is dragged by a shaft of prescribed
velocity Omega(t), angle phi(t) = integral of Omega, through Coulomb friction (static limit Ts,
kinetic Tk). T is the friction torque on the object:

    J theta'' + c theta' + kr theta = T

  stick    theta' = Omega, theta = theta0 + phi(t) - phi(t0); the torque this requires is
           T = kr theta + J Omega' + c Omega    (convention "physical"), or
           T = kr theta                         (conventions "paper" and "frozen").
  break    first t with s T = Ts; slip in the direction s = sign(T) begins. Also at a knot of the
           drive: Omega jumps ("velocity_jump", s = sign(Omega(t+) - theta'); "frozen" does not
           break), or Omega' jumps so that |T| > Ts ("accel_jump"); or at t = 0 ("initial").
  slip s   T = s Tk, lasts while g = s (Omega - theta') > 0. Closed form, with x = theta - s Tk/kr,
           a = c/(2J), wn^2 = kr/J, wd^2 = wn^2 - a^2, E = exp(-a h),
           C = E cos(wd h), S = E sin(wd h)/wd   (cosh, sinh, or 1, h when wd^2 <= 0):
               x(h)  = (C + a S) x + S v,     v(h) = -wn^2 S x + (C - a S) v.
  match    g falls to 0: "stick" if the torque required to stick is within Ts (relative slack
           1e-26), else "reverse": slip with s' = sign of that torque. A jump of Omega across
           theta' is a "reverse" at once (reason velocity_jump).
  touch    only for Ts = Tk: g reaches 0 with g' = 0 and rises again; the slip goes on.
  frozen   breaks like paper; the slip lasts (pi + 2 atan(|Omega(t0)| sqrt(J kr)/(Ts - Tk)))/wn
           whatever Omega does; then stick at theta = s (2 Tk - Ts)/kr. Needs c = 0.

How the first root of g (or of Ts - s T in stick) is found with certainty: from g, g' at t and a
bound M >= |g''| on the rest of the segment, g(t+h) >= g + g' h - M h^2/2, so no root lies before
the positive root of that parabola. Stepping there again and again never passes a root, and at a
transversal root it converges quadratically like Newton's method. M comes from the largest
|Omega'|, |Omega''|, |Omega'''| of the segment, and in slip from the energy-like v^2 + wn^2 x^2,
which never grows. A slip starts with g = 0, g' > 0, which the same step handles (2 g'/M); with
g = g' = 0 < g'' (Ts = Tk) the step comes from a bound on |g'''|. A slip that would start with
g' < 0 has no consistent continuation and is refused (Zeno).

All parameters are binary64 numbers, written so that parsing them gives the same bits, and used
exactly. Needs mpmath (faster with gmpy2).

    python3 generate.py [NAME...]               write NAME.json (default: all) beside this file
    python3 generate.py --check [NAME...]       recompute and compare with the files, write nothing
    python3 generate.py --validate DIR          compare with files of schema stickslip-truth/1
"""
import json
import math
import pathlib
import sys

from mpmath import (atan, atan2, cos, cosh, exp, findroot, hypot, log, mp, mpf, nstr, pi, sign, sin,
                    sinh, sqrt)

mp.dps = 60                      # 50 digits and a margin
HERE = pathlib.Path(__file__).resolve().parent
TINY = mpf(10) ** -50            # a step or a number this small is rounding
SLACK = 1 + mpf(10) ** -26       # relative slack of the static limit
DIGITS = 22                      # written


# ---- drives: lists of smooth segments -----------------------------------------------------------

class Linear:
    """Omega = w0 + a (t - ta) on [ta, tb]."""
    def __init__(self, ta, tb, w_start, w_end, phi_start):
        self.ta, self.tb, self.w, self.phi0 = ta, tb, w_start, phi_start
        self.a = (w_end - w_start) / (tb - ta)
        self.d1max, self.d2max, self.d3max = abs(self.a), mpf(0), mpf(0)

    def omega(self, t):
        """Omega and its first three derivatives."""
        return self.w + self.a * (t - self.ta), self.a, mpf(0), mpf(0)

    def phi(self, t):
        return self.phi0 + (self.w + self.a * (t - self.ta) / 2) * (t - self.ta)


class Sine:
    """phi = A sin(p t + shift): shift 0, or -pi/2 for phi = -A cos(p t)."""
    def __init__(self, tb, A, f, minus_cosine):
        self.ta, self.tb, self.A, self.p, self.minus_cosine = mpf(0), tb, A, 2 * pi * f, minus_cosine
        self.d1max, self.d2max, self.d3max = (abs(A) * self.p ** n for n in (2, 3, 4))

    def _trig(self, t):
        sn, cs = sin(self.p * t), cos(self.p * t)
        return (-cs, sn) if self.minus_cosine else (sn, cs)

    def omega(self, t):
        sn, cs = self._trig(t)
        A, p = self.A, self.p
        return A * p * cs, -A * p ** 2 * sn, -A * p ** 3 * cs, A * p ** 4 * sn

    def phi(self, t):
        return self.A * self._trig(t)[0]


def segments(drive, t_end, number):
    kind = drive["kind"]
    if kind == "const":
        w = number(drive["Omega"])
        return [Linear(mpf(0), t_end, w, w, mpf(0))]
    if kind in ("sine_position", "minus_cosine_position"):
        return [Sine(t_end, number(drive["A"]), number(drive["f_hz"]), kind[0] == "m")]
    result, phi = [], mpf(0)
    knots = [[number(k[key]) for key in ("t", "Omega_left", "Omega_right")] for k in drive["knots"]]
    assert kind == "piecewise_linear_velocity" and knots[0][0] == 0 and knots[-1][0] >= t_end
    for (ta, _, w_start), (tb, w_end, _) in zip(knots, knots[1:]):
        result.append(Linear(ta, tb, w_start, w_end, phi))
        phi = result[-1].phi(tb)
    return result


# ---- roots --------------------------------------------------------------------------------------

def first_root(f, ta, tb, skip=0):
    """First root after ta (and before tb) of a g >= 0, as (t, grazing); None if there is none.

    f(t) gives g, g', g'' and a bound on |g''| over [t, tb]; (ta, ta + skip) is known to be free."""
    t, first = ta + skip, skip == 0
    while t < tb:
        g, d, dd, M = f(t)
        if g <= 0:
            if not first or d < 0:
                return t, False
            g = mpf(0)                      # leaving zero
        first = False
        if d < 0:
            h = 2 * g / (sqrt(d * d + 2 * M * g) - d)
        elif M == 0:
            return None                     # constant or rising for ever
        elif g == 0 and d == 0:
            raise Zeno(f"g = g' = 0 at t = {nstr(t, 20)}")
        else:
            h = (d + sqrt(d * d + 2 * M * g)) / M
        if h < TINY:
            return (t + h, False) if t + h < tb else None
        if h < 1e-20 and d < 0 and g > d * d / (100 * M):
            for _ in range(3):              # a double root: find where g' = 0
                _, d, dd, _ = f(t)
                t -= d / dd
            return t, True
        t += h
    return None


class Zeno(Exception):
    pass


class Slip:
    """Free motion of the object from (t0, theta0, v0) under the torque s Tk."""
    def __init__(self, J, kr, c, Tk, s, t0, theta0, v0):
        self.s, self.t0, self.v0, self.rest = s, t0, v0, s * Tk / kr
        self.x0 = theta0 - self.rest
        self.a, self.wn2 = c / (2 * J), kr / J
        self.wn, self.wd2 = sqrt(self.wn2), self.wn2 - self.a ** 2

    def state(self, t):
        h, a, x, v = t - self.t0, self.a, self.x0, self.v0
        E, w = exp(-a * h), sqrt(abs(self.wd2))
        if self.wd2 > 0:
            C, S = E * cos(w * h), E * sin(w * h) / w
        elif self.wd2 < 0:
            C, S = E * cosh(w * h), E * sinh(w * h) / w
        else:
            C, S = E, E * h
        return self.rest + (C + a * S) * x + S * v, -self.wn2 * S * x + (C - a * S) * v

    def gap(self, t, seg):
        """g = s (Omega - v), g', g'', and bounds on |g''|, |g'''| until the end of the segment."""
        theta, v = self.state(t)
        x, a, wn, wn2, k = theta - self.rest, self.a, self.wn, self.wn2, 4 * self.a ** 2 - self.wn2
        w, w1, w2, _ = seg.omega(t)
        v1 = -2 * a * v - wn2 * x
        v2 = k * v + 2 * a * wn2 * x
        R = hypot(v, wn * x)
        M2 = seg.d2max + (abs(k) + 2 * a * wn) * R
        M3 = seg.d3max + (abs(k) * (2 * a + wn) + 2 * a * wn2) * R
        return self.s * (w - v), self.s * (w1 - v1), self.s * (w2 - v2), M2, M3


# ---- the simulation -----------------------------------------------------------------------------

def simulate(case, number):
    """All events of a case up to its t_end; number turns a parameter's text into an mpf."""
    J, kr, c, Tk, Ts = (number(case["params"][k]) for k in ("J", "kr", "c", "Tk", "Ts"))
    frozen, physical = case["convention"] == "frozen", case["convention"] == "physical"
    assert (frozen and c == 0) or physical or case["convention"] == "paper"
    Jr, cr = (J, c) if physical else (0, 0)         # what counts in the torque required to stick
    t_end = number(case["t_end"])
    segs = segments(case["drive"], t_end, number)
    events = []

    def required(t, theta, seg):
        w, w1, _, _ = seg.omega(t)
        return kr * theta + Jr * w1 + cr * w

    def emit(kind, t, theta, v, a, b, before, after, reason=None):
        event = dict(type=kind, t=t, theta=theta, theta_dot=v, phase_from=int(a), phase_to=int(b),
                     torque_before=before, torque_after=after)
        events.append(event | ({"reason": reason} if reason else {}))
        if len(events) > 3 and t - events[-4]["t"] < TINY:
            raise Zeno(f"events pile up at t = {nstr(t, 20)}")

    def slip_from(kind, theta, v, a, s, before, reason=None):
        """Emit an event that starts a slip; return the slip and how long g is surely positive."""
        emit(kind, t, theta, v, a, s, before, s * Tk, reason)
        slip = Slip(J, kr, c, Tk, s, t, theta, v)
        g, d, dd, _, M3 = slip.gap(t, seg)
        if frozen or g > TINY or d > TINY:
            return slip, 0
        if abs(d) <= TINY and Ts == Tk and dd > 0:
            return slip, 3 * dd / M3
        raise Zeno(f"slip at t = {nstr(t, 20)} starts with g' = {nstr(d, 5)}")

    def match(theta, v):
        """The velocities are equal: stick (no slip any more) or reverse (another slip)."""
        need = required(t, theta, seg)
        if frozen or abs(need) <= Ts * SLACK:
            emit("stick", t, theta, seg.omega(t)[0], slip.s, 0, slip.s * Tk, need)
            return None, 0
        return slip_from("reverse", theta, v, slip.s, sign(need), slip.s * Tk)

    index, t, theta, slip, skip, seg = 0, mpf(0), mpf(0), None, 0, segs[0]
    need = required(t, theta, seg)
    if abs(need) > Ts * SLACK:
        slip, skip = slip_from("break", theta, seg.omega(t)[0], 0, sign(need), None, "initial")

    while True:
        if slip and frozen:
            t = slip.t0 + (pi + 2 * atan(abs(slip.v0) * sqrt(J * kr) / (Ts - Tk))) / slip.wn
            if t > t_end:
                break
            while t >= seg.tb:
                index += 1
                seg = segs[index]
            theta = slip.s * (2 * Tk - Ts) / kr
            slip, skip = match(theta, None)
        elif slip:
            root = first_root(lambda u: slip.gap(u, seg)[:4], t, seg.tb, skip)
            if root and root[0] <= t_end:
                t, grazing = root
                theta, v = slip.state(t)
                if grazing and Ts == Tk:
                    emit("touch", t, theta, v, slip.s, slip.s, slip.s * Tk, slip.s * Tk)
                    _, _, dd, _, M3 = slip.gap(t, seg)
                    skip = 3 * dd / M3
                else:
                    slip, skip = match(theta, v)
                continue
        if not slip:
            theta0 = theta - seg.phi(t)
            M = kr * seg.d1max + Jr * seg.d3max + cr * seg.d2max

            def margin(u):
                """Ts - s T and its derivatives, for the s at hand."""
                w, w1, w2, w3 = seg.omega(u)
                return (Ts - s * (kr * (theta0 + seg.phi(u)) + Jr * w1 + cr * w),
                        -s * (kr * w + Jr * w2 + cr * w1), -s * (kr * w1 + Jr * w3 + cr * w2), M)
            roots = []
            for s in (1, -1):
                root = first_root(margin, t, seg.tb)
                if root and root[0] <= t_end:
                    roots.append((root[0], s))
            if roots:
                t, s = min(roots)
                theta = theta0 + seg.phi(t)
                slip, skip = slip_from("break", theta, seg.omega(t)[0], 0, s, s * Ts, "threshold")
                continue
            theta = theta0 + seg.phi(seg.tb)

        # nothing before the end of this segment: on to the next one
        if seg.tb >= t_end:
            break
        old, t, skip, index = seg, seg.tb, 0, index + 1
        seg = segs[index]
        w_old, w_new = old.omega(t)[0], seg.omega(t)[0]
        jump = w_new - w_old if abs(w_new - w_old) > TINY else 0
        if slip:
            theta, v = slip.state(t)
            gap = slip.s * (w_new - v)
            if jump and abs(gap) <= TINY:
                slip, skip = match(theta, v)
            elif jump and gap < 0:
                slip, skip = slip_from("reverse", theta, v, slip.s, -slip.s, slip.s * Tk, "velocity_jump")
        elif not frozen:
            need, before = required(t, theta, seg), required(t, theta, old)
            if jump:
                slip, skip = slip_from("break", theta, w_old, 0, sign(jump), before, "velocity_jump")
            elif abs(need) > Ts * SLACK:
                slip, skip = slip_from("break", theta, w_old, 0, sign(need), before, "accel_jump")
    return events


# ---- cases --------------------------------------------------------------------------------------

def const(omega):
    return {"kind": "const", "Omega": repr(float(omega))}


def sine(A, f, kind="sine_position"):
    return {"kind": kind, "A": repr(float(A)), "f_hz": repr(float(f))}


def linear(*knots):
    """Knots (t, Omega) or (t, Omega_left, Omega_right)."""
    full = [map(repr, map(float, (k + k[-1:])[:3])) for k in knots]
    return {"kind": "piecewise_linear_velocity",
            "knots": [dict(zip(("t", "Omega_left", "Omega_right"), k)) for k in full]}


def critical_damping(omega, J=0.01, kr=400.0, Tk=0.2, Ts=0.4):
    """The damping c above which a constant Omega leads to no re-stick after the first break."""
    J, kr, omega, drop = mpf(J), mpf(kr), mpf(omega), mpf(Ts) - mpf(Tk)
    lam = drop / (omega * sqrt(J * kr))

    def criterion(z):
        q = sqrt(1 - z * z)
        return log(1 - 2 * z * lam + lam ** 2) - 2 * z / q * (2 * pi - atan2(lam * q, 1 - z * lam))
    top = lam ** 2 / (4 * pi)               # the small-lambda limit; the root lies a little below
    return 2 * sqrt(J * kr) * findroot(criterion, (top * mpf("0.5"), top * mpf("1.2")), solver="anderson")


PAPER = dict(J=0.01, kr=400.0, c=0.0, Tk=0.2, Ts=0.4)
JUMPS = linear((0, 0.1), (0.004, 0.1, 0.6), (0.0875, 0.6, 0.1), (0.2, 0.1, -0.4), (0.3005, -0.4, 0.1),
               (0.4, 0.1, 0.6), (0.55, 0.6, 0.1), (0.6, 0.1, -0.05), (0.8, -0.05, 0.45), (1, 0.45))
THROUGH_ZERO = linear((0, 0.1), (0.012, 0.1), (0.032, -0.1), (0.3, -0.1), (0.33, 0.3), (0.4, 0.3),
                      (0.42, -0.2), (0.46, -0.2), (0.47, 0.1), (0.6, 0.1))
DWELL = linear((0, 0.3), (0.2, 0.3), (0.25, 0), (0.5, 0), (0.55, -0.3), (0.8, -0.3, 0), (1, 0, 0.4),
               (1.1, 0.4))
STOP = linear((0, 1), (1, 1), (1.05, 0), (2, 0))
TURNING = linear((0, 0.03), (0.1, 0.03), (0.2, -0.03), (0.3, -0.03), (0.4, 0.03), (0.5, 0.03, -0.03),
                 (0.7, -0.03))
KICKS = linear((0, 0.02), (0.03, 0.02), (0.04, 0.5), (0.2, 0.5), (0.204, -0.1), (0.3, -0.1), (0.31, 0.6),
               (0.5, 0.02), (0.56, 0.02), (0.58, -0.9), (0.7, -0.9))
WANDER = linear((0, 0.3), (0.049, -0.288), (0.118, -0.684, 0.057), (0.17, -0.567), (0.23, -0.74),
                (0.286, -0.688, -0.655), (0.341, 0.005), (0.378, -0.439), (0.446, 0.377, 0.123),
                (0.5, 0.762), (0.533, 0.574), (0.58, 0.01, -0.612), (0.629, -0.024), (0.67, 0.131),
                (0.738, -0.204, 0.076), (0.772, -0.332), (0.814, 0.172), (0.87, -0.297, 0.137),
                (0.927, -0.32), (1.005, 0.318), (1.05, 0.119, 0.04))


def all_cases():
    cases = {}

    def add(name, description, drive, t_end, convention="physical", **params):
        cases[name] = dict(name=name, description=description, convention=convention,
                           params={k: repr(float(v)) for k, v in (PAPER | params).items()},
                           drive=drive, t_end=repr(float(t_end)))

    def knee(f):
        return sine(math.pi / 4, f, "minus_cosine_position")

    add("c01_const_0p05", "constant 0.05 rad/s", const(0.05), 1.5)
    add("c05_const_3", "constant 3 rad/s", const(3), 1)
    add("n06_const_minus_1", "constant -1 rad/s", const(-1), 1)
    add("c03z_const_0p5_frozen", "constant 0.5 rad/s", const(0.5), 1, "frozen")
    add("s07_sine_0p25Hz", "45 degrees at 0.25 Hz", knee(0.25), 4)
    add("s07p_sine_0p25Hz_paper", "45 degrees at 0.25 Hz", knee(0.25), 4, "paper")
    add("s08_sine_0p5Hz", "45 degrees at 0.5 Hz", knee(0.5), 4)
    add("s08p_sine_0p5Hz_paper", "45 degrees at 0.5 Hz", knee(0.5), 4, "paper")
    add("t09_through_zero", "Omega passes 0 during slip", THROUGH_ZERO, 0.6)
    add("q10_velocity_jumps", "Omega jumps, in stick and in slip", JUMPS, 1)
    add("q10p_velocity_jumps_paper", "Omega jumps, in stick and in slip", JUMPS, 1, "paper")
    add("q10z_velocity_jumps_frozen", "Omega jumps, in stick and in slip", JUMPS, 1, "frozen")
    add("r11p_small_reversals_paper", "3 mrad: reversals inside stick", sine(0.003, 1), 3, "paper")
    add("r11z_small_reversals_frozen", "3 mrad: reversals inside stick", sine(0.003, 1), 3, "frozen")
    add("p12_presliding", "0.9 mrad at 1 Hz: never reaches Ts", sine(0.0009, 1), 3)
    add("d13_equal_torques", "Ts = Tk: breaks once, grazes ever after", const(1), 1, Tk=0.3, Ts=0.3)
    add("d14_nearly_equal_torques", "Ts = 1.0001 Tk: re-sticks for 150 ns", const(1), 1, Tk=0.3, Ts=0.30003)
    add("z14_zero_kinetic", "Tk = 0: re-sticks exactly on -Ts", const(1), 2, Tk=0)
    add("k15_stiff", "kr = 4e4, J = 1e-5", const(1), 0.006, kr=4e4, J=1e-5)
    add("l16_soft", "kr = 10", const(1), 10, kr=10)
    add("e18_supercritical", "damping ratio 0.02: slides for ever after one break", const(1), 10, c=0.08)
    add("f19_sine_2Hz", "45 degrees at 2 Hz: J Omega' > Ts from the start", knee(2), 1)
    add("f19s_sine_2Hz", "45 degrees at 2 Hz, starting at full speed", sine(math.pi / 4, 2), 1)
    add("g20_stop", "1 rad/s stops within 50 ms", STOP, 2)
    add("g20z_stop_frozen", "1 rad/s stops within 50 ms", STOP, 2, "frozen")
    add("a21_accel_jumps", "Omega' jumps, some above Ts/J", KICKS, 0.7)
    add("j21_light_1e-8", "J = 1e-8", const(1), 0.05, J=1e-8)
    add("j21_light_1e-9", "J = 1e-9", const(1), 0.05, J=1e-9)
    add("x22_dwell", "dwell at exactly 0, then reverse; jump to and from 0", DWELL, 1.1)
    add("x22z_dwell_frozen", "dwell at exactly 0, then reverse; jump to and from 0", DWELL, 1.1, "frozen")
    for name, omega in (("m23_lambda_0p1", 1.0), ("m23_lambda_1", 0.1)):
        critical = critical_damping(omega)
        for side, factor in (("below", 1 - mpf(10) ** -6), ("above", 1 + mpf(10) ** -6)):
            add(f"{name}_{side}", f"damping 1e-6 {side} the critical one", const(omega), 1,
                c=float(critical * factor))
    add("o24_overdamped", "damping ratio 1.5", sine(0.004, 2), 2, c=6)
    add("o25_critically_damped", "damping ratio exactly 1", TURNING, 0.7, J=0.0625, c=10)
    add("o25_nearly_critical_below", "damping ratio 1 - 1e-10", TURNING, 0.7, J=0.0625, c=10 * (1 - 1e-10))
    add("o25_nearly_critical_above", "damping ratio 1 + 1e-10", TURNING, 0.7, J=0.0625, c=10 * (1 + 1e-10))
    add("o26_damped_sine", "damping ratio 0.2", sine(0.02, 1), 3, c=0.8)
    add("o26p_damped_sine_paper", "damping ratio 0.2", sine(0.02, 1), 3, "paper", c=0.8)
    for letter, convention in (("", "physical"), ("p", "paper"), ("z", "frozen")):
        add(f"w27{letter}_wander_{convention}", "random-looking velocity with jumps", WANDER, 1.05,
            convention)
    return cases


# ---- files --------------------------------------------------------------------------------------

def decimal(x):
    return None if x is None else "0" if abs(x) < TINY * 1e5 else nstr(x, DIGITS)


def text(case):
    """A case, simulated, as JSON: one field a line, one event a line."""
    events = [{k: decimal(v) if isinstance(v, mpf) else v for k, v in e.items()}
              for e in simulate(case, lambda s: mpf(float(s)))]
    counts = {kind: sum(e["type"] == kind for e in events) for kind in sorted({e["type"] for e in events})}
    head = {"schema": "stickslip-events/1", **case, "event_counts": counts}
    lines = [f' {json.dumps(k)}: {json.dumps(v)},\n' for k, v in head.items()]
    rows = ",\n".join("  " + json.dumps(e, separators=(",", ":")) for e in events)
    return "{\n" + "".join(lines) + ' "events": [\n' + rows + ("\n" if rows else "") + " ]\n}\n", counts


def validate(folder):
    """Recompute files of schema stickslip-truth/1 from their decimal parameters; true if all agree."""
    good = True
    for path in sorted(pathlib.Path(folder).glob("*.json")):
        case = json.loads(path.read_text())
        case["convention"] = {"full": "physical", "paper7": "paper"}.get(case["convention"], case["convention"])
        events, theirs = simulate(case, mpf), case["events"]
        labels = ("type", "phase_from", "phase_to", "reason")
        same = [[e.get(k) for k in labels] for e in events] == [[e.get(k) for k in labels] for e in theirs]
        numbers = ("t", "theta", "theta_dot", "torque_before", "torque_after")
        worst = {k: max(abs(e[k] - mpf(o[k])) for e, o in zip(events, theirs) if o[k]) for k in numbers}
        good &= same and all(w < 1e-25 for w in worst.values())
        print(f"{path.stem}: {len(events)} events, sequence {'equal' if same else 'DIFFERENT'}, "
              "largest differences " + ", ".join(f"{k} {nstr(w, 2)}" for k, w in worst.items()))
    return good


def main(arguments):
    if arguments[:1] == ["--validate"] and len(arguments) == 2:
        return validate(arguments[1])
    check = arguments[:1] == ["--check"]
    cases, good = all_cases(), True
    names = arguments[check:] or list(cases)
    if unknown := [n for n in names if n not in cases]:
        sys.exit(f"unknown case {', '.join(unknown)}; there are: {', '.join(cases)}")
    for name in names:
        path = HERE / f"{name}.json"
        content, counts = text(cases[name])
        result = f"{len(content)} bytes"
        if check:
            same = path.exists() and path.read_text() == content
            good &= same
            result = "same" if same else "DIFFERENT"
        else:
            path.write_text(content)
        print(f"{name}: {json.dumps(counts)}, {result}", flush=True)
    return good


if __name__ == "__main__":
    sys.exit(0 if main(sys.argv[1:]) else 1)
