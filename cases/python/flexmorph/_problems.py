"""Design problems with exact gradients, for optimizers of any package."""

import numpy as np

from . import _core
from ._errors import InputError, NumericalError
from ._results import Design


class NoHessian(InputError, AttributeError):
    """The problem has no second derivatives; the message says why."""


class Evaluation:
    """Values and gradients at one design.

    Attributes
    ----------
    f : float
        Objective.
    df : numpy.ndarray
        Gradient of the objective (n).
    g : numpy.ndarray
        Constraints g <= 0 (m).
    dg : numpy.ndarray
        Gradients of the constraints, one row each (m, n).
    """

    __slots__ = ("f", "df", "g", "dg")

    def __init__(self, f, df, g, dg):
        self.f, self.df, self.g, self.dg = f, df, g, dg


class Solution(dict):
    """The result of `Problem.solve`; entries are attributes, too."""

    def __getattr__(self, name):
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"this solution has no {name!r}; it has {', '.join(self)}") from None

    def __dir__(self):
        return list(self)

    def __repr__(self):
        return f"<flexmorph.Solution: {', '.join(self)}>"


class Problem:
    """The problem: minimize f(x) subject to g(x) <= 0 and lower <= x <= upper.

    `Case.problem` creates it. The variables are scaled, so that a step of 0.05 moves a component
    by about a cell. Compliances are minimized and limited as logarithms. All functions at one x cost
    one factorization (or one motion with its adjoint); the last designs are kept by the bytes of x.

    An object of this class can be passed to ``cyipopt.Problem(problem_obj=...)`` as it is.

    Attributes
    ----------
    x0, lower, upper : numpy.ndarray
        Start design and bounds (n).
    names, constraint_names : list of str
        Names of the variables (n), such as "rocker.3.angle", and of the constraints (m).
    n, m : int
        Numbers of variables and of constraints.
    bodies : list of str
        Names of the bodies, in the order of their variables.
    has_hessian : bool
        True if the problem has second derivatives.
    evaluations : int
        Number of computed designs; designs from the cache do not count.
    """

    def __init__(self, case, core):
        self._case, self._core = case, core
        self.x0, self.lower, self.upper = core.x0, core.lower, core.upper
        self.names, self.constraint_names = core.names, core.constraint_names
        self.n, self.m, self.bodies, self.has_hessian = core.n, core.m, core.bodies, core.has_hessian

    evaluations = property(lambda self: self._core.evaluations)

    def __repr__(self):
        return f"<flexmorph.Problem of {', '.join(self.bodies)}: {self.n} variables, {self.m} constraints>"

    def at(self, stage, x=None):
        """Return the problem under the same loads in another formulation, from the design x.

        Parameters
        ----------
        stage : {"coarse", "eroded", "last"}
            Formulation, see `Case.problem`.
        x : array_like, optional
            Design (n) at which the new problem starts, moved into the bounds; by default the start of
            this problem.
        """
        x = np.clip(self.x0 if x is None else np.asarray(x, float), self.lower, self.upper)
        return Problem(self._case, self._core.at(stage, x))

    def evaluate(self, x):
        """Return all values and gradients at x as an `Evaluation`."""
        return Evaluation(*self._core.evaluate(x))

    def objective(self, x):
        """Return the objective f(x)."""
        return self._core.evaluate(x)[0]

    def gradient(self, x):
        """Return the gradient of the objective (n)."""
        return self._core.evaluate(x)[1]

    def constraints(self, x):
        """Return the constraints g(x) <= 0 (m)."""
        return self._core.evaluate(x)[2]

    def jacobian(self, x):
        """Return the gradients of the constraints, one row each (m, n)."""
        return self._core.evaluate(x)[3]

    def hessian_matrix(self, x, lagrange, obj_factor=1.0):
        """Return obj_factor Hess f + sum lagrange_i Hess g_i at x (n, n)."""
        self._require_hessian()
        return self._core.hessian(x, np.asarray(lagrange, float), obj_factor)

    def _require_hessian(self):
        if not self.has_hessian:
            raise NoHessian(
                "this problem has no second derivatives: they exist for compliances and sums over "
                "cells without limits on widths or on the crisp design, for example with stage="
                "\"coarse\"; has_hessian tells it")

    @property
    def hessian(self):
        """Function (x, lagrange, obj_factor) -> lower triangle of the Hessian, as cyipopt asks.

        The entries are in the order of `hessianstructure`. Without second derivatives the attribute
        does not exist for ``hasattr``, and `NoHessian` says why.
        """
        self._require_hessian()
        return lambda x, lagrange, obj_factor: (
            self.hessian_matrix(x, lagrange, obj_factor)[np.tril_indices(self.n)])

    @property
    def hessianstructure(self):
        """Function that returns rows and columns of the entries of `hessian`."""
        self._require_hessian()
        return lambda: np.tril_indices(self.n)

    def cyipopt(self):
        """Return the keyword arguments of ``cyipopt.Problem``."""
        return {"n": self.n, "m": self.m, "problem_obj": self, "lb": self.lower, "ub": self.upper,
                "cl": np.full(self.m, -np.inf), "cu": np.zeros(self.m)}

    def box(self, x, size):
        """Return lower and upper bounds of a box around x, inside the bounds of the problem.

        Optimizers without a move limit take first steps that change every bar by several cells; the
        linearized functions say nothing about such designs. Inside a box of three move limits, 0.15,
        steps stay where they hold; the next box begins at the design that was found.

        Parameters
        ----------
        x : array_like
            Centre of the box (n).
        size : float
            Largest change of a variable.

        Returns
        -------
        tuple of numpy.ndarray
            Lower and upper bounds (n).
        """
        x = np.asarray(x, float)
        return np.maximum(self.lower, x - size), np.minimum(self.upper, x + size)

    def scipy(self, x=None, *, box=None, hessian=False):
        """Return the keyword arguments of ``scipy.optimize.minimize`` (trust-constr, SLSQP).

        A design that cannot be evaluated has infinite values, so that the method takes a shorter
        step.

        Parameters
        ----------
        x : array_like, optional
            Start (n); by default that of the problem.
        box : float, optional
            Largest change of a variable, see `box`; by default the bounds of the problem.
        hessian : bool, optional
            True to add second derivatives, which trust-constr uses.

        Returns
        -------
        dict
        """
        from scipy.optimize import BFGS, Bounds, NonlinearConstraint
        if hessian:
            self._require_hessian()

        def or_infinite(function, infinite):
            def value(x):
                try:
                    return function(x)
                except NumericalError:
                    return infinite
            return value
        x = np.clip(self.x0 if x is None else np.asarray(x, float), self.lower, self.upper)
        bounds = (self.lower, self.upper) if box is None else self.box(x, box)
        out = {"fun": or_infinite(self.objective, np.inf), "jac": self.gradient, "x0": x,
               "bounds": Bounds(*bounds)}
        if self.m:
            second = BFGS()
            if hessian:
                def second(x, v):
                    return self.hessian_matrix(x, v, 0.0)
            values = or_infinite(self.constraints, np.full(self.m, np.inf))
            out["constraints"] = NonlinearConstraint(values, -np.inf, 0, jac=self.jacobian, hess=second)
        if hessian:
            out["hess"] = lambda x: self.hessian_matrix(x, np.zeros(self.m), 1.0)
        return out

    def nlopt(self, x, grad):
        """Return f and fill the gradient: the argument of ``nlopt.opt.set_min_objective``."""
        if grad.size:
            grad[:] = self.gradient(x)
        return self.objective(x)

    def nlopt_constraints(self, result, x, grad):
        """Fill g and its gradients: the argument of ``nlopt.opt.add_inequality_mconstraint``."""
        result[:] = self.constraints(x)
        if grad.size:
            grad[:] = self.jacobian(x)

    def acceptable(self, x):
        """Return True if x may become a design: material connects every load to a support."""
        return self._core.acceptable(x)

    def crisp(self, x):
        """Return numbers of the crisp designs that the outlines of x enclose, by bodies."""
        return dict(zip(self.bodies, self._core.crisp(np.asarray(x, float))))

    def designs(self, x):
        """Return the designs at x by bodies, see `Design`."""
        crisp = self.crisp(x)
        return {body: Design(self._case, body, each, crisp[body])
                for body, each in self._core.components(np.asarray(x, float)).items()}

    def solve(self, optimizer="", *, stages=None, callback=None, **options):
        """Solve the problem with an optimizer of Flexmorph or of `add_optimizer`.

        Parameters
        ----------
        optimizer : str, optional
            Name of the optimizer, such as "mma"; by default that of the case.
        stages : bool, optional
            True: the bodies are designed through all stages of the first cycle of a run, from the
            start designs of the case; the result has the bits of the program. False: this problem is
            minimized from x0. By default True, or False for responses of the motion.
        callback : callable, optional
            Function that is called after every iteration with a dictionary; True stops.
        **options : float
            ``max_iterations``, ``max_evaluations``, ``kkt_tolerance``, ``change_tolerance``,
            ``move_limit``, and options of the optimizer.

        Returns
        -------
        Solution
            With stages: ``designs`` by bodies, whose ``results`` are the numbers of the design.
            Without: ``x``, ``fun``, ``constraints``, ``kkt``, ``violation``, ``nit``, ``nfev``,
            ``status``, ``message``, ``success``, and ``designs`` at x. Always: ``crisp_violation``,
            the largest relative amount by which a crisp design exceeds a limit; 0 up to 0.5 %, and
            infinite if no material connects a load to a support. The other numbers without stages
            are those of the smoothed design.
        """
        options = {name: float(value) for name, value in options.items()}
        if stages or (stages is None and not self._of_motion):
            found = self._core.design(optimizer, options, callback)
            out = Solution(designs={body: Design(self._case, body, *each)
                                    for body, each in found.items()})
        else:
            out = Solution(self._core.minimize(optimizer, options, callback))
            out["designs"] = self.designs(out["x"])
        out["crisp_violation"] = max(design.results["crisp_violation"]
                                     for design in out["designs"].values())
        return out

    _of_motion = False


def problem_of(case, body, stage, of, cell, step):
    """Create a problem, see `Case.problem`."""
    if of not in ("loads", "motion"):
        raise InputError(f"of = '{of}': the responses are those of the loads or of the motion")
    out = Problem(case, _core.Problem(case._core, body or "", stage, of == "motion", cell, step))
    out._of_motion = of == "motion"
    return out
