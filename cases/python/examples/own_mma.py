"""The method of moving asymptotes in Python, as an optimizer that cases can name.

Svanberg (1987): f and g are replaced by convex separable functions of 1/(U - x) and 1/(x - L). The
subproblem is solved in its dual, with one multiplier per constraint.
"""
import numpy as np
from scipy.optimize import minimize

import flexmorph


def approximation(df, x, L, U, span):
    """Return p and q of sum p/(U - x) + q/(x - L) with the gradient df at x."""
    up, down = np.maximum(df, 0), np.maximum(-df, 0)
    more = 1e-3 * (up + down) + 1e-5 / span
    return (U - x) ** 2 * (up + more), (x - L) ** 2 * (down + more)


def subproblem(e, x, L, U, low, high, span):
    """Return the minimum of the convex subproblem within [low, high]."""
    p0, q0 = approximation(e.df, x, L, U, span)
    P, Q = approximation(e.dg, x, L, U, span)
    rest = e.g - P @ (1 / (U - x)) - Q @ (1 / (x - L))

    def primal(multipliers):
        p, q = np.sqrt(p0 + multipliers @ P), np.sqrt(q0 + multipliers @ Q)
        return np.clip((p * L + q * U) / (p + q), low, high)

    def dual(multipliers):
        y = primal(multipliers)
        g = P @ (1 / (U - y)) + Q @ (1 / (y - L)) + rest
        f = p0 @ (1 / (U - y)) + q0 @ (1 / (y - L))
        return -(f + multipliers @ g), -g

    found = minimize(dual, np.zeros(len(e.g)), jac=True, bounds=[(0, 1e4)] * len(e.g),
                     method="L-BFGS-B", options={"ftol": 1e-14, "gtol": 1e-10, "maxiter": 500})
    return primal(found.x)


def mma(search):
    """Minimize until the search ends."""
    x, limit = search.x0, search.options["move_limit"]
    span = search.upper - search.lower
    e, distance, before = search.evaluate(x), np.full(search.n, 2 * limit), []
    while search.iterate(x):
        if len(before) == 2:  # asymptotes approach where a variable oscillates, else they go away
            sign = (x - before[1]) * (before[1] - before[0])
            distance *= np.where(sign < 0, 0.7, np.where(sign > 0, 1.2, 1.0))
            distance = np.clip(distance, 0.1 * limit, 10 * limit)
        low = np.maximum(search.lower, x - np.minimum(limit, 0.9 * distance))
        high = np.minimum(search.upper, x + np.minimum(limit, 0.9 * distance))
        trial = subproblem(e, x, x - distance, x + distance, low, high, span)
        found = search.evaluate(trial)
        while found is None:  # refused: half of the step
            trial = x + 0.5 * (trial - x)
            found = search.evaluate(trial)
        before = [*before[-1:], x]
        x, e = trial, found


if __name__ == "__main__":
    flexmorph.add_optimizer("python_mma", mma)
    case = flexmorph.load("short_beam", set={"design.cell": 0.05, "design.min_thickness": 0.05,
                                             "optimizer.max_iterations": 120})
    for optimizer in ("python_mma", "mma"):
        design = case.problem().solve(optimizer).designs["beam"]
        print(optimizer, design.results["crisp_compliance"], "J", design.results["crisp_volume"])
