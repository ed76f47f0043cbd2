"""Optimizers of Python on shipped cases, against the optimizers of Flexmorph (label benchmark).

Usage: benchmark_optimizers.py [CASE | METHOD]...   METHOD: SLSQP trust-constr nlopt python_mma

Every method goes through the stages coarse, eroded and last of the first cycle. SciPy and NLopt
have no move limit; they run inside boxes that move (`Problem.box`). The designs are compared by the
compliance of the crisp design under equal loads. The exit code is 1 if a constraint is violated by
more than 1e-3, or if the compliance exceeds that of the reference by more than 3 %, and 77 if SciPy
or NLopt for Python is absent.
"""

import pathlib
import re
import sys
import time

import numpy as np

import flexmorph

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "cases" / "python" / "examples"))
import own_mma  # noqa: E402

BOXES = {"trust-constr": 12}  # of every stage (others: 10) but the last, which has twice as many
BOX = 0.15  # largest change of a variable inside a box, three move limits
TOLERANCE = 1e-3  # of constraints, which are relative

# SciPy's first trust region, and its barrier, in variables and functions of the order of 1.
TRUST = {"maxiter": 20, "initial_tr_radius": 0.5, "initial_barrier_parameter": 1e-4,
         "initial_barrier_tolerance": 1e-4}
OPTIONS = {"SLSQP": {"maxiter": 10}, "trust-constr": TRUST}


def with_scipy(method):
    def minimize(problem):
        from scipy.optimize import minimize
        return minimize(**problem.scipy(box=BOX), method=method, options=OPTIONS[method]).x
    return minimize


def with_nlopt(problem):
    """Minimize with NLopt inside a box of 1.5 move limits, as nlopt_mma does."""
    import nlopt
    opt = nlopt.opt(nlopt.LD_MMA, problem.n)
    lower, upper = problem.box(problem.x0, 0.5 * BOX)
    opt.set_lower_bounds(lower)
    opt.set_upper_bounds(upper)
    opt.set_min_objective(problem.nlopt)
    opt.add_inequality_mconstraint(problem.nlopt_constraints, np.full(problem.m, 1e-5))
    opt.set_maxeval(20)
    try:
        return opt.optimize(problem.x0)
    except nlopt.RoundoffLimited:
        return problem.x0


def staged(problem, minimize, boxes):
    """Minimize through all stages; return the results of the design and its largest violation."""
    for stage in ("coarse", "eroded", "last"):
        problem = problem.at(stage)
        for _ in range(boxes * (2 if stage == "last" else 1)):
            problem = problem.at(stage, minimize(problem))
    violation = problem.constraints(problem.x0).max()
    return next(iter(problem.designs(problem.x0).values())).results, violation


def problem_limit(case):
    """Return the largest volume fraction that a case allows."""
    return float(re.search(r"^max_volume *= *([0-9.]+)", case.text, re.MULTILINE).group(1))


METHODS = {"SLSQP": ("mma", with_scipy("SLSQP")), "trust-constr": ("mma", with_scipy("trust-constr")),
           "nlopt": ("nlopt_mma", with_nlopt), "python_mma": ("mma", None)}


def main():
    flexmorph.add_optimizer("python_mma", own_mma.mma)
    failed = False
    cases = [a for a in sys.argv[1:] if a not in METHODS] or ["short_beam", "rotating_plate_v01"]
    methods = [a for a in sys.argv[1:] if a in METHODS] or list(METHODS)
    for name in cases:
        case = flexmorph.load(name)
        problem = case.problem(stage="coarse")
        references = {}
        for method in methods:
            reference, minimize = METHODS[method]
            if reference not in references:
                design = next(iter(problem.solve(reference).designs.values())).results
                references[reference] = design["crisp_compliance"]
            begin = time.process_time()
            if minimize is None:
                found = next(iter(problem.solve(method).designs.values())).results
                compliance, volume = found["crisp_compliance"], found["crisp_volume"]
                violation = volume / problem_limit(case) - 1
            else:
                found, violation = staged(problem, minimize, BOXES.get(method, 10))
                compliance, volume = found["compliance"], found["volume"]
            expected = references[reference]
            ratio = compliance / expected
            fails = not (ratio < 1.03 and violation <= TOLERANCE)
            failed = failed or fails
            print(f"{name}: {method}: {compliance:.5g} J, volume {volume:.4f}, violation "
                  f"{violation:.1e}; {reference}: {expected:.5g} J; ratio {ratio:.4f}"
                  f"{' FAILED' if fails else ''}, {time.process_time() - begin:.0f} s CPU", flush=True)
    return failed


if __name__ == "__main__":
    try:
        sys.exit(main())
    except ImportError as error:
        print(f"skipped: {error}")
        sys.exit(77)
