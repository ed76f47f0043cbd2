"""Optimizers of Python on shipped cases, against the optimizers of Flexmorph (label benchmark).

Usage: benchmark_optimizers.py [CASE | METHOD]...   METHOD: SLSQP trust-constr nlopt python_mma

Every method goes through the stages coarse, eroded and last of the first cycle. The designs are
compared by the compliance of the crisp design under equal loads. The exit code is 1 if a design is
infeasible, or if its compliance exceeds that of the reference by more than 3 %, and 77 if SciPy or
NLopt for Python is absent.
"""

import pathlib
import sys
import time

import numpy as np

import flexmorph

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "cases" / "python" / "examples"))
import own_mma  # noqa: E402

ITERATIONS = 100  # of every stage but the last, which has twice as many
VOLUME_TOLERANCE = 5e-3  # relative, as for designs of the program (usable designs)


def with_scipy(method):
    def minimize(problem, iterations):
        from scipy.optimize import minimize
        hessian = method == "trust-constr" and problem.has_hessian
        options = {"maxiter": iterations}
        if method == "trust-constr":
            options["initial_tr_radius"] = 0.2  # variables are scaled: some cells
        return minimize(**problem.scipy(hessian=hessian), method=method, options=options).x
    return minimize


def with_nlopt(problem, iterations):
    """Minimize with NLopt inside boxes of 1.5 move limits that move, as nlopt_mma does."""
    import nlopt
    x = problem.x0
    for _ in range(iterations // 10):
        opt = nlopt.opt(nlopt.LD_MMA, problem.n)
        opt.set_lower_bounds(np.maximum(problem.lower, x - 0.075))
        opt.set_upper_bounds(np.minimum(problem.upper, x + 0.075))
        opt.set_min_objective(problem.nlopt)
        opt.add_inequality_mconstraint(problem.nlopt_constraints, np.full(problem.m, 1e-5))
        opt.set_maxeval(20)
        try:
            x = opt.optimize(x)
        except nlopt.RoundoffLimited:
            break
    return x


def staged(problem, minimize):
    for stage in ("coarse", "eroded", "last"):
        problem = problem.at(stage)
        x = minimize(problem, ITERATIONS * (2 if stage == "last" else 1))
        problem = problem.at(stage, np.clip(x, problem.lower, problem.upper))
    return next(iter(problem.designs(problem.x0).values())).results


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
                references[reference] = design["crisp_compliance"], design["crisp_volume"]
            begin = time.time()
            if minimize is None:
                found = next(iter(problem.solve(method).designs.values())).results
                compliance, volume = found["crisp_compliance"], found["crisp_volume"]
            else:
                found = staged(problem, minimize)
                compliance, volume = found["compliance"], found["volume"]
            expected, limit = references[reference]
            ratio = compliance / expected
            fails = not (ratio < 1.03 and volume <= limit * (1 + VOLUME_TOLERANCE))
            failed = failed or fails
            print(f"{name}: {method}: {compliance:.5g} J, volume {volume:.4f}; {reference}: "
                  f"{expected:.5g} J, volume {limit:.4f}; ratio {ratio:.4f}"
                  f"{' FAILED' if fails else ''}, {time.time() - begin:.0f} s", flush=True)
    return failed


if __name__ == "__main__":
    try:
        sys.exit(main())
    except ImportError as error:
        print(f"skipped: {error}")
        sys.exit(77)
