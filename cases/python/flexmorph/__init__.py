"""Flexmorph: topology optimization of flexible mechanisms.

>>> import flexmorph
>>> case = flexmorph.load("short_beam", set={"design.max_volume": 0.5})
>>> run = case.run()                          # doctest: +SKIP
>>> run.designs["beam"].plot()                # doctest: +SKIP

The page cases/docs/python.md explains the package step by step.
"""

from . import _core
from ._cases import Case, load
from ._errors import Error, InputError, NumericalError
from ._parts import Cells, Search, add_drive, add_force_element, add_optimizer, add_response
from ._problems import Evaluation, NoHessian, Problem, Solution
from ._results import Design, Run, Table, read

__all__ = ["Case", "Cells", "Design", "Error", "Evaluation", "InputError", "NoHessian", "NumericalError",
           "Problem", "Run", "Search", "Solution", "Table", "add_drive", "add_force_element",
           "add_optimizer", "add_response",
           "build_info", "keys", "load", "optimizers", "read", "shipped_cases"]


def build_info():
    """Describe the build and the process.

    Returns
    -------
    dict
        ``version`` of Flexmorph, ``commit`` of its sources, ``blas_kernel`` in use, ``vectors``
        (widest instructions in use), ``threads`` that OpenMP would use by default, and versions of
        ``libraries``. Results are equal bit for bit if ``version``, ``commit``, ``blas_kernel``,
        ``vectors`` and ``libraries`` are equal.
    """
    return _core.build_info()


def shipped_cases():
    """Return the names of the shipped cases, which `load` accepts."""
    return _core.shipped_cases()


def keys(word="", width=100):
    """Return the reference of the keys of case files as a text.

    Parameters
    ----------
    word : str, optional
        Path of a table, such as ``"body.flow"``, or part of a name or of a sentence; by default all
        tables.
    width : int, optional
        Number of characters of a line.

    Returns
    -------
    str
    """
    return _core.keys(word, width)


def optimizers():
    """Return the names of all optimizers, those of `add_optimizer` included."""
    return _core.optimizers()


__version__ = _core.build_info()["version"]
