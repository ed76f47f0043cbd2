"""Responses, drives, force elements and optimizers that are functions of Python."""

import numpy as np

from . import _core
from ._problems import Evaluation


class Cells:
    """The cells of a design, as a response sees them; fields have the shape (ny, nx).

    Attributes
    ----------
    x, y : numpy.ndarray
        Centres of the cells [m].
    mass, stiffness : numpy.ndarray
        Scale factors of mass and stiffness [-]: 0 for void, 1 for material.
    area, thickness, density : float
        Area of a cell [m^2], thickness of the plate [m], density of the material [kg/m^3].
    components : numpy.ndarray
        Components of the design (N, 7), see `Design.components`.
    """

    def __init__(self, x, y, mass, stiffness, area, thickness, density, components):
        self.x, self.y, self.mass, self.stiffness = x, y, mass, stiffness
        self.area, self.thickness, self.density, self.components = area, thickness, density, components


class Search:
    """The search of an optimizer: evaluations, bounds and the rows of the history.

    Attributes
    ----------
    x0, lower, upper : numpy.ndarray
        Start design and bounds (n).
    n, m : int
        Numbers of variables and of constraints.
    options : dict
        ``max_iterations``, ``move_limit``, ``kkt_tolerance``, ``feasibility``, and options of the
        optimizer.
    """

    def __init__(self, core):
        self._core = core
        self.x0, self.lower, self.upper = core.x0, core.lower, core.upper
        self.n, self.m, self.options = core.n, core.m, core.options

    def evaluate(self, x):
        """Return the `Evaluation` at x (n), or None if this design is refused: take another one."""
        found = self._core.evaluate(np.asarray(x, float))
        return None if found is None else Evaluation(*found)

    def iterate(self, x):
        """Record x, which was evaluated, as an iterate; return False when the search has ended."""
        return self._core.iterate(np.asarray(x, float))


def add_response(name, fun, unit="", *, words=None, linear=False):
    """Add a response that cases can minimize or limit under its name.

    Parameters
    ----------
    name : str
        Name in cases: ``design.constraint = [{response = "name", at_most = 0.8}]``.
    fun : callable
        ``fun(cells)`` returns the value and a dictionary of its derivatives by the fields
        ``"mass"`` and ``"stiffness"`` of `Cells`, each of the shape (ny, nx); what is left out is 0.
    unit : str, optional
        Unit of the value.
    words : str, optional
        Name in messages.
    linear : bool, optional
        True if the value is a sum over the mass factors; such responses have second derivatives.

    Notes
    -----
    Responses are added before the cases that name them are loaded. Adding a name again replaces
    its function; the other arguments keep their first values.
    """
    _core.add_response(name, fun, unit, words or name, linear)


def add_drive(name, fun, sentence=None):
    """Add a function of time that drives can name: ``from = "name"``.

    Parameters
    ----------
    name : str
        Name in cases.
    fun : callable
        ``fun(t)`` returns value, rate and acceleration at the time t [s]. Value and rate are
        continuous.
    sentence : str, optional
        Sentence that describes the drive.
    """
    _core.add_drive(name, fun, sentence or "A function of Python.")


def add_force_element(name, fun, sentence=None):
    """Add a force between two points, for ``[[spring]]`` with ``type = "name"`` (planar cases).

    Parameters
    ----------
    name : str
        Name in cases.
    fun : callable
        ``fun(r, v, t)`` returns the force on the point b [N] (2), and its derivatives by r and by v
        (2, 2); r and v are position and velocity of b relative to a [m], [m/s] (2). The opposite
        force acts on a.
    sentence : str, optional
        Sentence that describes the force.
    """
    _core.add_force_element(name, fun, sentence or "A function of Python.")


def add_optimizer(name, fun):
    """Add an optimizer that cases and `Problem.solve` can name.

    Parameters
    ----------
    name : str
        Name in cases: ``optimizer.name = "name"``.
    fun : callable
        ``fun(search)`` minimizes with a `Search`: it evaluates designs and calls
        ``search.iterate(x)`` for every iterate until that returns False. The best feasible iterate is
        the result.
    """
    _core.add_optimizer(name, fun)
