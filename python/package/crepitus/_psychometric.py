"""The psychometric function of choices between two alternatives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Fit:
    """A psychometric function p(d) = 1/2 + (1/2 − lapse)·F((d − threshold)/scale).

    Attributes:
        threshold: Difference at which F is 1/2.
        interval: Its 95 % interval, of the profile likelihood; infinite where the answers do not bound it.
        scale: Standard deviation of the normal distribution, or scale of the logistic.
        lapse: Share of wrong answers to any difference, however large.
        deviance: Twice the log-likelihood ratio to the saturated model; about χ² with as many degrees of freedom
            as levels less 3 if the function fits and each level has several trials.
        shape: ``gauss`` or ``logistic``.
    """

    threshold: float
    interval: tuple[float, float]
    scale: float
    lapse: float
    deviance: float
    shape: str

    def share(self, difference: Union[float, Array]) -> Any:
        """Share of right answers to a difference."""
        special = _scipy().special
        f = special.ndtr if self.shape == "gauss" else special.expit
        return 0.5 + (0.5 - self.lapse) * f((np.abs(difference) - self.threshold) / self.scale)

    def at(self, share: float) -> float:
        """The difference with this share of right answers; NaN if there is none."""
        f = (share - 0.5) / (0.5 - self.lapse)
        if not 0.0 < f < 1.0:
            return math.nan
        special = _scipy().special
        z = special.ndtri(f) if self.shape == "gauss" else special.logit(f)
        return float(self.threshold + self.scale * z)


def fit_threshold(
    differences: Union[Sequence[float], Array],
    trials: Union[Sequence[int], npt.NDArray[Any]],
    right: Union[Sequence[int], npt.NDArray[Any]],
    *,
    shape: str = "gauss",
    most_lapse: float = 0.1,
    level: float = 0.95,
) -> Fit:
    """Fits threshold, scale and lapse by maximum likelihood, with SciPy (``pip install crepitus[experiments]``).

    Args:
        differences: Comparison less reference at each level, not 0; of differences below 0 the size counts.
        trials: Number of trials at each level.
        right: Right answers at each level.
        shape: ``gauss`` or ``logistic``.
        most_lapse: Largest lapse that is believed.
        level: Confidence of the interval.

    Raises:
        ValueError: Fewer than two levels, or counts that are none.
        ImportError: SciPy is not installed.
    """
    scipy = _scipy()
    if shape not in ("gauss", "logistic"):
        raise ValueError(f"shape {shape!r}: expected gauss or logistic")
    x = np.abs(np.asarray(differences, dtype=float))
    n, k = np.asarray(trials, dtype=float), np.asarray(right, dtype=float)
    if not (x.shape == n.shape == k.shape and x.ndim == 1 and len(np.unique(x)) > 1):
        raise ValueError("expected two levels or more, with trials and right answers of each")
    if not (np.isfinite(x).all() and (x > 0).all() and (n > 0).all() and (k >= 0).all() and (k <= n).all()):
        raise ValueError("expected differences that are not 0, one trial or more at each, and no more right ones")
    f = scipy.special.ndtr if shape == "gauss" else scipy.special.expit
    span = float(x.max() - x.min())
    limits = [
        (float(x.min()) - 2.0 * span, float(x.max()) + 2.0 * span),
        (math.log(span / 200.0), math.log(span * 4.0)),
        (0.0, most_lapse),
    ]

    def loss(values: Array) -> tuple[float, Array]:
        """Negative log-likelihood and its gradient by threshold, logarithm of the scale, and lapse."""
        threshold, log_scale, lapse = values
        scale = math.exp(log_scale)
        z = (x - threshold) / scale
        share = f(z)
        density = np.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi) if shape == "gauss" else share * (1.0 - share)
        p = np.clip(0.5 + (0.5 - lapse) * share, 1e-12, 1.0 - 1e-12)
        of_p = (n - k) / (1.0 - p) - k / p
        slope = of_p * (0.5 - lapse) * density
        gradient = np.array([-(slope / scale).sum(), -(slope * z).sum(), -(of_p * share).sum()])
        return float(-(k * np.log(p) + (n - k) * np.log1p(-p)).sum()), gradient

    def least(function: Any, starts: list[Any], bounds: Any) -> Any:
        minimize = scipy.optimize.minimize
        found = [minimize(function, start, jac=True, method="L-BFGS-B", bounds=bounds) for start in starts]
        return min(found, key=lambda each: each.fun)

    scales = [math.log(span / 3.0), math.log(span / 10.0)]
    starts = [[float(m), s, 0.01] for m in np.quantile(x, [0.25, 0.5, 0.75]) for s in scales]
    best = least(loss, starts, limits)
    threshold, log_scale, lapse = (float(value) for value in best.x)
    most = float(best.fun) + 0.5 * float(scipy.stats.chi2.ppf(level, 1))

    def profile(fixed: float) -> float:
        """Least loss with this threshold, less the one at the ends of the interval."""

        def others(values: Array) -> tuple[float, Array]:
            value, gradient = loss(np.array([fixed, *values]))
            return value, gradient[1:]

        starts = [[log_scale, lapse], [log_scale + 1.0, 0.5 * most_lapse]]
        return float(least(others, starts, limits[1:]).fun) - most

    def end(direction: float) -> float:
        edge = limits[0][0] if direction < 0 else limits[0][1]
        inside, step = threshold, 0.3 * math.exp(log_scale)
        while True:
            outside = inside + direction * step
            if (outside - edge) * direction >= 0.0:
                outside = edge
            if profile(outside) > 0.0:
                tolerance = 1e-5 * span
                return float(scipy.optimize.brentq(profile, min(inside, outside), max(inside, outside), xtol=tolerance))
            if outside == edge:
                return direction * math.inf
            inside, step = outside, 1.6 * step

    with np.errstate(divide="ignore", invalid="ignore"):
        share = k / n
        saturated = np.where(k > 0, k * np.log(share), 0.0) + np.where(k < n, (n - k) * np.log1p(-share), 0.0)
    return Fit(
        threshold=threshold,
        interval=(end(-1.0), end(1.0)),
        scale=math.exp(log_scale),
        lapse=lapse,
        deviance=max(0.0, 2.0 * (float(best.fun) + float(saturated.sum()))),
        shape=shape,
    )


def power_abx(trials: int, share: float, *, alpha: float = 0.05) -> float:
    """Probability that A, B and X find a difference: of ``trials`` so many are right that chance gives as many with
    a probability of at most ``alpha``, by a participant who is right in this ``share``."""
    binom = _scipy().stats.binom
    right = np.arange(trials + 1)
    tail = binom.sf(right - 1, trials, 0.5)
    needed = right[tail <= alpha]
    return float(binom.sf(needed[0] - 1, trials, share)) if len(needed) else 0.0


def _scipy() -> Any:
    try:
        import scipy  # type: ignore[import-untyped, unused-ignore]
        import scipy.optimize  # type: ignore[import-untyped, unused-ignore]
        import scipy.special  # type: ignore[import-untyped, unused-ignore]
        import scipy.stats  # type: ignore[import-untyped, unused-ignore]
    except ImportError as error:
        raise ImportError("fits of thresholds need SciPy: pip install scipy") from error
    return scipy
