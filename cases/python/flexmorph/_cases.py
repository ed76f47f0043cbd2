"""Cases: loading, checking, motions and runs."""

import os

from . import _core, _toml
from ._errors import InputError
from ._problems import problem_of
from ._results import Run, Table, history_of, read


def load(case, set=None, *, threads=1, name="case"):
    """Load a case and build its models, so that errors of the input are found here.

    Parameters
    ----------
    case : str, os.PathLike or dict
        Path of a case file, name of a shipped case (`shipped_cases`), or the contents of a case file
        as a dictionary. A list of dictionaries stands for tables ``[[...]]``.
    set : dict, optional
        Changed keys by their dotted paths, as after ``--set``: ``{"design.max_volume": 0.4}``. The
        value None removes a key.
    threads : int, optional
        Number of threads of all computations with the case.
    name : str, optional
        Name of a case that is given as a dictionary.

    Returns
    -------
    Case

    Raises
    ------
    InputError
        With the attributes ``file``, ``line``, ``column`` and ``key`` where they are known.
    NumericalError
        If the mechanism cannot be assembled at its start.
    """
    changes = _toml.changes(set)
    if isinstance(case, dict):
        return Case(_core.load(name + ".toml", _toml.document(case), changes, threads))
    return Case(_core.load(os.fspath(case), None, changes, threads))


class Case:
    """A case that can be checked and computed; `load` creates it.

    Attributes
    ----------
    name, title : str
        Name and title of the case.
    threads : int
        Number of threads of its computations.
    """

    def __init__(self, core):
        self._core = core

    def __repr__(self):
        return f"<flexmorph.Case {self.name}: {self.title}>"

    name = property(lambda self: self._core.name)
    title = property(lambda self: self._core.title)
    threads = property(lambda self: self._core.threads)

    @property
    def text(self):
        """Text of the case file, with the changed keys."""
        return self._core.text

    def check(self):
        """Return a text about the contents, the unused features and the cost of the case."""
        return self._core.check()

    def explained(self):
        """Return the case with the values of all keys and a sentence to each."""
        return self._core.explained()

    @property
    def columns(self):
        """Unit and meaning of every column of the tables of a run (dict of tuples)."""
        return self._core.columns()

    @property
    def start(self):
        """Components of the start designs by bodies, arrays (N, 7), see `Design.components`."""
        return self._core.start_designs()

    def motion(self, designs=None, *, step=None, cells=0):
        """Compute one motion without files.

        Parameters
        ----------
        designs : dict or Run, optional
            Components (N, 7) of designed bodies by their names, or the designs of a run. Bodies
            without an entry have their start designs.
        step : float, optional
            Time step [s]; by default that of the case.
        cells : int, optional
            Elements per design cell in each direction, for designed bodies that are meshed by the
            cells of their designs; 0 for the mesh of the case.

        Returns
        -------
        Table
            One row per time step.
        """
        if isinstance(designs, Run):
            designs = {name: each.components for name, each in designs.designs.items()}
        return Table._of(self._core.motion(dict(designs or {}), step, cells))

    def problem(self, body=None, *, stage="last", of="loads", cell=0.0, step=0.0):
        """Create a design problem of the case.

        If bodies move, the motion with the start designs is computed first: it gives the equivalent
        static loads of the first design cycle.

        Parameters
        ----------
        body : str, optional
            Designed body; not needed if the case designs one body only. Bodies that share a limit
            on their mass are designed together.
        stage : {"last", "eroded", "coarse"}, optional
            Formulation: "last" is the one that reported numbers belong to (nominal stiffness in the
            narrow band, widths as constraints); "eroded" has the stiffness of the eroded design;
            "coarse" is the first band of the continuation.
        of : {"loads", "motion"}, optional
            "motion": the responses are those of the motion itself, with exact gradients by its
            adjoint; all designed bodies are variables then.
        cell, step : float, optional
            Size of the cells [m] and time step [s] of that motion; 0: those of the case.

        Returns
        -------
        Problem
        """
        return problem_of(self, body, stage, of, cell, step)

    def run(self, folder=None, *, progress=None, callback=None, resume=False):
        """Compute the case as the command ``flexmorph run`` does.

        Parameters
        ----------
        folder : str or os.PathLike, optional
            Run folder, which receives the files that the program writes. None writes no files.
        progress : callable, optional
            Function that receives the messages and progress lines of the run: ``progress(text)``.
        callback : callable, optional
            Function that is called after every design iteration with a dictionary of its values
            (columns of history.csv) and the scaled variables ``x`` of the body. If it returns True,
            the run ends after this iteration and has the status "interrupted".
        resume : bool, optional
            True to resume a run of this case in the folder.

        Returns
        -------
        Run

        Raises
        ------
        NumericalError
            If the run fails; the files of the folder are written before.
        KeyboardInterrupt
            After Ctrl-C; the files of the folder are written before, and the run can be resumed.
        """
        if folder is not None:
            self._core.compute_into(os.fspath(folder), resume, progress, callback)
            return read(folder)
        if resume:
            raise InputError("a run without a folder cannot be resumed")
        rows = []

        def observe(row):
            rows.append(row)
            return callback(dict(row)) if callback else None

        result = self._core.compute(progress, observe)
        return Run._computed(self, result, history_of(rows, self.columns))
