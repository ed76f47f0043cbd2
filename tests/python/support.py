"""Functions of the tests of the Python package."""

import csv
import json
import os
import pathlib
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).parent
SHORT_PLATE = str(HERE.parent / "cases" / "short_plate.toml")
PROGRAM = os.environ["FLEXMORPH_PROGRAM"]


# A rigid bar that hangs from a pin, driven by nothing: period and energy are known.
PENDULUM = {
    "title": "Pendulum",
    "gravity": [0.0, -9.81],
    "time": {"end": 0.5, "step": 1e-3},
    "rigid_body": [{"name": "bar", "mass": 1.0, "size": [0.4, 0.02], "center": [0.2, 0.0],
                    "position": [0.0, 0.0], "angle": 0.0}],
    "joint": [{"type": "revolute", "name": "pin", "a": "ground", "point_a": [0.0, 0.0], "b": "bar"}],
}
SMALL_BEAM = {"design.cell": 0.1, "design.min_thickness": 0.1, "optimizer.max_iterations": 4,
              "output.plots": False, "output.vtk": False}


def run_program(folder, case, changes=()):
    """Run the program into a folder and return run.json."""
    options = [each for change in changes for each in ("--set", change)]
    subprocess.run([PROGRAM, "run", case, *options, "--quiet", "-o", str(folder)], check=False,
                   stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=200)
    return json.loads((pathlib.Path(folder) / "run.json").read_text())


def run_python(script, kernel, *arguments):
    """Run a script in a process of its own with kernels of OpenBLAS, and return its output."""
    env = {**os.environ, "OPENBLAS_CORETYPE": kernel}
    done = subprocess.run([sys.executable, "-c", script, *map(str, arguments)], env=env, text=True,
                          stdin=subprocess.DEVNULL, capture_output=True, timeout=200)
    assert done.returncode == 0, done.stderr
    return done.stdout


def without_times(value):
    """Return values of run.json without times and memory."""
    if isinstance(value, dict):
        return {k: without_times(v) for k, v in value.items()
                if not k.startswith("seconds") and k != "peak_memory_bytes"}
    return [without_times(each) for each in value] if isinstance(value, list) else value


def contents(folder):
    """Return the contents of the files of a run without times: by path, bytes or values."""
    out = {}
    for path in sorted(pathlib.Path(folder).rglob("*")):
        name = str(path.relative_to(folder))
        if not path.is_file() or name in ("report.html", ".flexmorph"):
            continue  # they contain times and the number of the process
        if name == "run.json":
            out[name] = without_times(json.loads(path.read_text()))
        elif name == "history.csv":
            rows = list(csv.reader(path.read_text().splitlines()))
            kept = [k for k, title in enumerate(rows[0]) if not title.startswith("seconds")]
            out[name] = [[row[k] for k in kept] for row in rows]
        else:
            out[name] = path.read_bytes()
    return out


def taylor_orders(function, gradient, x, direction, steps):
    """Return the orders with which |f(x + h d) - f(x) - h f' d| falls between successive steps."""
    f, slope = function(x), gradient(x) @ direction
    errors = [np.max(np.abs(function(x + h * direction) - f - h * slope)) for h in steps]
    return [np.log(a / b) / np.log(g / h)
            for a, b, g, h in zip(errors, errors[1:], steps, steps[1:])]
