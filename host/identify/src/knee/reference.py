"""Jackknife, clusters, Student's t and bounded least squares by SciPy, as constants of the tests.

Every fit without a group is a fit of its own, by a singular value decomposition; the prior is more rows.
"""

import numpy as np
from scipy import stats
from scipy.linalg import lstsq
from scipy.optimize import lsq_linear

i = np.arange(30.0)
x = np.column_stack([np.ones(30), np.sin(0.7 * i), 0.1 * i + np.cos(1.9 * i)])
y = 2.0 - 0.5 * x[:, 1] + 0.3 * x[:, 2] + 0.2 * np.sin(5.3 * i * i)
residual = y - x @ lstsq(x, y)[0]
prior = np.diag([0.0, 0.4, 2.5])
blocks = [(0, 4), (4, 9), (9, 15), (15, 20), (20, 26), (26, 30)]
groups = (i * 7 % 4).astype(int)


def change(rows):
    """Coefficients that fit these rows of the residual, near none."""
    columns = np.vstack([x[rows], np.sqrt(prior)])
    return lstsq(columns, np.concatenate([residual[rows], np.zeros(3)]))[0]


moves, left_out = [], []
for start, end in blocks:
    inside = (i >= start) & (i < end)
    moves.append(change(~inside))
    # Squares of a model, for the comparison.
    left_out.append(np.sum((residual[inside] - x[inside] @ moves[-1]) ** 2))
moves = np.array(moves)
covariance = np.cov(moves.T, bias=True) * (len(blocks) - 1)
pulls = np.zeros((3, 3))
for group in range(4):
    of_group = np.where(groups == group, residual, 0.0)
    columns = np.vstack([x, np.sqrt(prior)])
    by = lstsq(columns, np.concatenate([of_group, np.zeros(3)]))[0]
    pulls += np.outer(by, by)
# Strokes that count, where one of them moves a value more than the others together.
few = np.array([0.1, -0.02, 0.03, 1.0, 0.5, -0.05])
kurtosis = [np.mean(m**4) / np.mean(m**2) ** 2 for m in (moves.T[0], few)]
# A paired comparison of two models over blocks: t = mean/(deviation/√n).
other = np.array([0.31, 0.22, 0.47, 0.18, 0.36, 0.25])
paired = stats.ttest_rel(other, left_out)


def rust(name, values):
    values = np.asarray(values, dtype=float)
    text = ", ".join(repr(float(v)) for v in values.ravel())
    print(f"const {name}: [f64; {values.size}] = [{text}];")


rust("LEFT_OUT", left_out)
rust("MOVES", moves)
rust("COVARIANCE", covariance)
rust("BY_GROUP", pulls)
rust("COUNTING", [min(3.0 * len(blocks) / k, len(blocks)) for k in kurtosis])
rust("PAIRED", [np.sum(other - left_out) / np.sum(other), paired.statistic])
rust("STUDENT", [stats.t.ppf(0.975, n) for n in (2, 2.7, 3, 5.5, 11, 19, 60, 400)])

i = np.arange(20.0)
x = np.column_stack([np.ones(20), np.sin(0.3 * i), np.exp(0.11 * i), np.exp(0.12 * i), np.cos(1.7 * i)])
y = np.exp(0.2 * i) - 3.0 * np.sin(0.3 * i) + np.sin(2.9 * i)
bounds = ([-4, -1, 0, -9, 0], [40, 1, 3, 9, np.inf])
rust("SCIPY", lsq_linear(x, y, bounds, method="bvls", tol=1e-15).x)
