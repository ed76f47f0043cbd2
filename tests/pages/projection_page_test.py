"""Shows on pages of real runs that paths of equilibria and bodies in space are animated: places of
observed points are those of the tables, projected for bodies in space.

    python3 projection_page_test.py PROGRAM
"""

import csv
import json
import math
import os
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from page_data import data_of

PROGRAM = sys.argv.pop(1)
TOLERANCE = 1e-6  # of places relative to the size of the picture


def run(case, folder, table, *changes):
    """Runs a case; returns the data of its page, the columns of a table, and run.json."""
    options = [word for change in ("output.vtk=false", "expect=", *changes) for word in ("--set", change)]
    ended = subprocess.run([PROGRAM, "run", case, "-o", folder, "--quiet", *options], capture_output=True,
                           text=True)
    if ended.returncode not in (0, 5):  # 5: the run is complete, but its design is not usable
        raise RuntimeError(case + ": " + ended.stderr)
    with open(folder + "/report.html", encoding="utf-8") as page:
        data = data_of(page.read())
    with open(folder + "/" + table, newline="") as file:
        rows = list(csv.DictReader(file))
    with open(folder + "/run.json", encoding="utf-8") as file:
        summary = json.load(file)
    return data, {name: [number(row[name]) for row in rows] for name in rows[0]}, summary


def number(text):
    """The number in a cell; None if it is no number."""
    try:
        return float(text)
    except ValueError:
        return None


def seen(x, y, z):
    """The place of a point in a picture whose viewer is at azimuth -55 and elevation 25 degrees."""
    a, e = math.radians(-55), math.radians(25)
    along = math.cos(a) * x + math.sin(a) * y
    return -math.sin(a) * x + math.cos(a) * y, -math.sin(e) * along + math.cos(e) * z


def place(motion, name, frame):
    """The place of an observed point in a frame."""
    mark = next(m for m in motion["marks"] if m["name"] == name)
    return [v * motion["unit"] for v in mark["at"][3 * frame:3 * frame + 2]]


class Projections(unittest.TestCase):
    def run_case(self, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            return run(arguments[0], folder + "/run", *arguments[1:])

    def assert_at(self, motion, found, expected):
        size = 1e8 * motion["unit"]
        for a, b in zip(found, expected):
            self.assertAlmostEqual(a, b, delta=TOLERANCE * size)

    def test_a_path_moves_by_the_displacements_of_its_table(self):
        data, table, _ = self.run_case("lee_frame", "path.csv", "body.column.elements=10",
                                       "body.leg.elements=10")
        motion = data["motion"]
        self.assertEqual(motion["factor"], [float(f"{v:.17g}") for v in
                                            (table["load_factor"][int(k)] for k in motion["time"])])
        self.assertEqual((motion["time"][0], motion["time"][-1]), (0, len(table["step"]) - 1))
        start = place(motion, "leg.loaded", 0)
        self.assertGreater(max(abs(v) for v in table["leg.loaded_uy"]), 10)
        for frame, step in enumerate(motion["time"]):
            moved = [a + table[f"leg.loaded_u{c}"][int(step)] for a, c in zip(start, "xy")]
            self.assert_at(motion, place(motion, "leg.loaded", frame), moved)

    def test_bodies_in_space_are_projected(self):
        data, table, _ = self.run_case("plate_pendulum", "motion.csv", "time.end=0.2",
                                       "body.plate.elements=[2, 2]", "time.step=2e-3")
        motion = data["motion"]
        grid = motion["bodies"][0]
        for frame, t in enumerate(motion["time"]):
            row = min(range(len(table["time"])), key=lambda r: abs(table["time"][r] - t))
            corner = seen(*(table[f"plate.corner_{c}"][row] for c in "xyz"))
            self.assert_at(motion, place(motion, "plate.corner", frame), corner)
            # The far corner of the grid is the observed point.
            self.assert_at(motion, [v * motion["unit"] for v in grid["points"][frame][-2:]], corner)
        # At the start nothing is deformed; later the rigid motion differs from the points.
        self.assertLessEqual(max(abs(a - b) for a, b in zip(grid["points"][0], grid["rigid"][0])), 2)
        self.assertGreater(max(abs(a - b) for a, b in zip(grid["points"][-1], grid["rigid"][-1])), 1e4)

    def test_a_plate_at_rest_has_the_displacements_of_its_loads(self):
        data, _, summary = self.run_case("short_beam", "loads/beam.csv", "design.cell=0.1",
                                         "design.min_thickness=0.1", "optimizer.max_iterations=0")
        self.assertNotIn("motion", data)
        loads = data["static_loads"]
        at = loads["x"].index(2.0) * len(loads["y"]) + loads["y"].index(0.5)
        moved = loads["loads"][0]["displacement"][2 * at + 1] * loads["loads"][0]["unit"]
        # The work of the unit force on its displacement is the compliance of the crisp design.
        compliance = summary["results"][0]["crisp_compliance"]
        self.assertAlmostEqual(-moved, compliance, delta=1e-4 * compliance)


if __name__ == "__main__":
    unittest.main()
