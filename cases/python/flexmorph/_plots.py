"""Pictures with matplotlib, which is imported at the first picture only."""

import numpy as np


def _axes(ax):
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError("pictures need matplotlib (Debian: python3-matplotlib)") from error
    return pyplot.subplots()[1]


def design(of, ax, style):
    """Draw the outline of a design."""
    ax = _axes(ax)
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path
    for outer, holes in of.outline:
        rings = [np.vstack([ring, ring[:1]]) for ring in (outer, *holes)]
        codes = [[Path.MOVETO] + [Path.LINETO] * (len(r) - 2) + [Path.CLOSEPOLY] for r in rings]
        path = Path(np.vstack(rings), np.concatenate(codes))
        ax.add_patch(PathPatch(path, **{"facecolor": "0.3", "edgecolor": "none", **style}))
    x, y = of.x, of.y
    ax.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]), aspect="equal", xlabel="x [m]", ylabel="y [m]",
           title=of.body)
    return ax


def table(of, names, x, ax):
    """Draw columns of a table over another column."""
    ax = _axes(ax)
    x = x or ("iteration" if "iteration" in of else next(iter(of)))
    names = names or [n for n in of if n != x and of[n].dtype.kind == "f"][:1]
    for name in names:
        ax.plot(of[x], of[name], label=f"{name} [{of.units.get(name, '')}]")
    ax.set_xlabel(f"{x} [{of.units.get(x, '')}]")
    ax.legend()
    return ax
