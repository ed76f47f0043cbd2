"""Results of runs: tables, designs, and what their folders contain."""

import csv
import json
import os

import numpy as np

from . import _core
from ._errors import InputError


# Columns of the files of components, in the order of `Design.components`.
PARAMETERS = ("X0", "Y0", "half_length", "angle", "c1", "c2", "c3")


class Table(dict):
    """A table: arrays of equal length by the names of their columns.

    ``pandas.DataFrame(table)`` and matplotlib's ``data=table`` accept it as it is.

    Attributes
    ----------
    units, meanings : dict
        Unit and meaning of every column; the unit "-" stands for a number without a unit.
    """

    def __init__(self, columns=(), units=None, meanings=None):
        super().__init__(columns)
        self.units, self.meanings = dict(units or {}), dict(meanings or {})

    @classmethod
    def _of(cls, core):
        names = core["names"]
        values = core["values"]
        return cls({n: np.array(values[:, k]) for k, n in enumerate(names)},
                   dict(zip(names, core["units"])), dict(zip(names, core["meanings"])))

    @property
    def columns(self):
        """Names of the columns (list of str)."""
        return list(self)

    @property
    def n_rows(self):
        """Number of rows."""
        return len(next(iter(self.values()))) if self else 0

    def plot(self, *names, x=None, ax=None):
        """Draw columns over the first column or over the column `x` (matplotlib)."""
        from . import _plots
        return _plots.table(self, names, x, ax)

    def __repr__(self):
        return f"<flexmorph.Table of {self.n_rows} rows: {', '.join(self)}>"

    __str__ = __repr__


def _column(cells):
    """Return texts of a CSV file, or values, as an array: numbers where possible, NaN where empty."""
    try:
        return np.array([np.nan if c in ("", None) else float(c) for c in cells])
    except ValueError:
        return np.array(["" if c is None else str(c) for c in cells])


def history_of(rows, columns):
    """Return the table of design iterations from the dictionaries of a callback."""
    names = [name for name in (rows[0] if rows else ()) if name != "x"]
    described = {name: columns.get(name, ("", "")) for name in names}
    return Table({name: _column([row[name] for row in rows]) for name in names},
                 {n: d[0] for n, d in described.items()}, {n: d[1] for n, d in described.items()})


def _read_csv(path, columns):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    names = rows[0] if rows else []
    described = {n: columns.get(n, ("s" if n.startswith("seconds") else "", "")) for n in names}
    return Table({n: _column([row[k] for row in rows[1:]]) for k, n in enumerate(names)},
                 {n: d[0] for n, d in described.items()}, {n: d[1] for n, d in described.items()})


class Design:
    """The design of one body.

    Attributes
    ----------
    body : str
        Name of the body.
    components : numpy.ndarray
        Components (N, 7): centre X0, Y0 [m], half length [m], angle [rad], and half thickness at
        the start, the end and the middle of the axis c1, c2, c3 [m].
    results : dict
        Numbers of the design by their names in run.json.
    """

    def __init__(self, case, body, components, results):
        self._case, self.body, self.results = case, body, results
        self.components = np.array(components)
        self._geometry = None

    def _get(self, name):
        if self._geometry is None:
            self._geometry = self._case._core.geometry(self.body, self.components)
        return self._geometry[name]

    @property
    def x(self):
        """Edges of the cells along x [m] (nx + 1)."""
        return self._get("x").copy()

    @property
    def y(self):
        """Edges of the cells along y [m] (ny + 1)."""
        return self._get("y").copy()

    @property
    def density(self):
        """Area fraction of material of every cell [-] (ny, nx); row 0 is the lowest one."""
        return self._get("density").copy()

    @property
    def outline(self):
        """Polygons of the part: a list of (outer ring, list of holes), rings are (n, 2) [m]."""
        return [(outer.copy(), [hole.copy() for hole in holes])
                for outer, holes in self._get("outline")]

    @property
    def points(self):
        """Nodes of the cells [m] ((nx + 1) (ny + 1), 2), as meshio.Mesh takes them."""
        x, y = np.meshgrid(self._get("x"), self._get("y"))
        return np.column_stack([x.ravel(), y.ravel()])

    @property
    def quads(self):
        """Nodes of every cell (nx ny, 4), in the order of ``density.ravel()``."""
        n = len(self._get("x"))
        first = (np.arange(len(self._get("y")) - 1)[:, None] * n + np.arange(n - 1)).ravel()
        return np.column_stack([first, first + 1, first + n + 1, first + n])

    def plot(self, ax=None, **style):
        """Draw the outline (matplotlib); `style` goes to the filled patch. Returns the axes."""
        from . import _plots
        return _plots.design(self, ax, style)

    def __repr__(self):
        return f"<flexmorph.Design of {self.body}: {len(self.components)} components>"


def _described(tables):
    schema = _core.result_schema()
    rows = [row for table in tables for row in schema[table]]
    return "\n".join(f"    {name}{f' [{unit}]' if unit else ''}\n        {meaning}"
                     for name, unit, meaning in rows)


Design.__doc__ += f"""
    Notes
    -----
    Entries of ``results``, where the case has them:

{_described(("design", "length_scale", "outline"))}
    """


class Run:
    """The results of a run, whether it was computed here (`Case.run`) or read (`read`).

    Attributes
    ----------
    case : Case
        The case of the run.
    folder : str or None
        Run folder; None if there is none.
    status : str
        "done", "done, not usable", "interrupted" or "failed".
    warnings : list of str
        Warnings about the results.
    summary : dict
        Contents of run.json.
    history : Table
        One row per design iteration and body; empty without designs.
    motion : Table or None
        One row per time step; None if there is no motion.
    tables : dict
        All tables by the names of their files without ``.csv``.
    designs : dict
        Designs by the names of their bodies, see `Design`.
    """

    def __init__(self, case, folder, summary, tables, components):
        self.case, self.folder, self.summary, self.tables = case, folder, summary, tables
        self.status = summary.get("status", "")
        self.warnings = list(summary.get("warnings", []))
        self.history = tables.get("history", Table())
        self.motion = tables.get("motion")
        results = {each.get("body"): each for each in summary.get("results", [])}
        self.designs = {body: Design(case, body, each, results.get(body, {}))
                        for body, each in components.items()}

    @classmethod
    def _computed(cls, case, core, history):
        tables = {name: Table._of(each) for name, each in core["tables"].items()}
        if history:
            tables["history"] = history
        return cls(case, None, json.loads(core["json"]), tables, core["components"])

    def __repr__(self):
        return f"<flexmorph.Run of {self.case.name}: {self.status}>"


def read(folder):
    """Read the folder of a run of the program or of `Case.run`.

    Parameters
    ----------
    folder : str or os.PathLike
        Run folder.

    Returns
    -------
    Run
        The same object that `Case.run` returns.

    Raises
    ------
    InputError
        If the folder contains no run.
    """
    from ._cases import Case
    folder = os.fspath(folder)
    for name in ("case.toml", "run.json"):
        if not os.path.isfile(os.path.join(folder, name)):
            raise InputError(f"'{folder}' is not the folder of a run: it does not contain {name}")
    with open(os.path.join(folder, "run.json"), encoding="utf-8") as file:
        summary = json.load(file)
    case = Case(_core.load(os.path.join(folder, "case.toml"), None, [], summary.get("threads", 1)))
    columns = case.columns
    tables = {}
    for name in sorted(os.listdir(folder)):
        if name.endswith(".csv") and not name.startswith("components"):
            tables[name[:-4]] = _read_csv(os.path.join(folder, name), columns)
    components = {}
    for body, start in case.start.items():
        path = os.path.join(folder, case._core.components_file(body))
        components[body] = start
        if os.path.isfile(path):
            table = _read_csv(path, {})
            components[body] = np.column_stack([table[n] for n in PARAMETERS])
    return Run(case, folder, summary, tables, components)
