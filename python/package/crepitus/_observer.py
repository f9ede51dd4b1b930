"""Observers who are simulated: what an experiment finds of them is known."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from .experiments import Trial


class Observer:
    """A participant with a known psychometric function.

    The share of right answers to a difference d is 1/2 + (1/2 − lapse)·F((d − threshold)/scale), with F the
    cumulative normal distribution (``gauss``) or the logistic function; without a difference it is 1/2.
    """

    def __init__(
        self, threshold: float, scale: float, *, lapse: float = 0.02, shape: str = "gauss", seed: int = 0
    ) -> None:
        if shape not in ("gauss", "logistic"):
            raise ValueError(f"shape {shape!r}: expected gauss or logistic")
        self.threshold = threshold
        self.scale = scale
        self.lapse = lapse
        self.shape = shape
        self._random = np.random.default_rng(seed)

    def share(self, difference: float) -> float:
        """Share of right answers."""
        if difference == 0.0:
            return 0.5
        z = (abs(difference) - self.threshold) / self.scale
        f = 0.5 * math.erfc(-z / math.sqrt(2.0)) if self.shape == "gauss" else 0.5 * (1.0 + math.tanh(z / 2.0))
        return 0.5 + (0.5 - self.lapse) * f

    def choose(self, trial: Trial) -> int:
        """The interval that it takes for the one that has more."""
        first, second = (interval.reveal()["values"] for interval in trial.intervals)
        # All but one value are equal.
        difference = _sum(first) - _sum(second)
        is_right = self._random.random() < self.share(difference)
        return 1 if (difference > 0.0) == is_right else 2


def _sum(values: dict[str, Any]) -> float:
    return float(sum(values.values()))
