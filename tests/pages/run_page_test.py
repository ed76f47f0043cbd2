"""Shows on pages of real runs that the animation is at the places of motion.csv and that the page
needs no other file.

    python3 run_page_test.py PROGRAM
"""

import csv
import math
import os
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from page_data import data_of, references_of

TOLERANCE = 1e-6  # of places [m] and angles [rad]
PROGRAM = sys.argv.pop(1)
CASES = {
    # A mechanism of rigid bodies with springs, closed loops and a drive.
    "andrews": ["time.end=0.01", "output.vtk=false"],
    # A designed plate between rigid bodies, with uniform material beside it.
    "four_bar": ["time.end=0.1", "time.step=2e-3", "optimizer.max_iterations=2", "esl.every=0.05",
                 "design.cell=0.01", "design.min_thickness=0.01", "cycle.max_cycles=1", "verify=", "output.vtk=false"],
    # A plate on a hub that becomes longer.
    "deploying_beam": ["output.vtk=false"],
}


def run(case, folder):
    """Runs a case with its changes; returns the text of its page and the columns of motion.csv."""
    changes = [word for change in CASES[case] for word in ("--set", change)]
    # Exit code 5: the run is complete, but so few iterations give no usable design.
    ended = subprocess.run([PROGRAM, "run", case, "-o", folder, "--quiet", "--set", "expect="] + changes,
                           capture_output=True, text=True)
    if ended.returncode not in (0, 5):
        raise RuntimeError(case + ": " + ended.stderr)
    with open(folder + "/report.html", encoding="utf-8") as page:
        text = page.read()
    with open(folder + "/motion.csv", newline="") as table:
        rows = list(csv.DictReader(table))
    return text, {name: [float(row[name]) for row in rows] for name in rows[0]}


def turns(angle):
    """The difference of two angles without whole turns."""
    return math.remainder(angle, 2 * math.pi)


class EveryPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.runs = {}
        for case in CASES:
            folder = cls.scratch.name + "/" + case
            page, table = run(case, folder)
            cls.runs[case] = folder, page, data_of(page), table

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def each(self):
        for case, (folder, page, data, table) in self.runs.items():
            with self.subTest(case=case):
                yield folder, page, data, table

    def test_frames_are_steps_of_the_motion(self):
        for _, _, data, table in self.each():
            times = data["motion"]["time"]
            self.assertGreater(len(times), 10)
            self.assertEqual(times[0], table["time"][0])
            self.assertEqual(times[-1], table["time"][-1])
            self.assertTrue(set(times) <= set(table["time"]))

    def test_bodies_are_where_the_table_says(self):
        compared = 0
        for _, _, data, table in self.each():
            motion = data["motion"]
            rows = [table["time"].index(t) for t in motion["time"]]
            for body in motion["bodies"]:
                if body["name"] + ".angle" not in table:
                    continue
                for frame, row in enumerate(rows):
                    x, y, angle = body["poses"][3 * frame:3 * frame + 3]
                    expected = [table[body["name"] + "." + c][row] for c in ("x", "y", "angle")]
                    self.assertAlmostEqual(x * motion["unit"], expected[0], delta=TOLERANCE)
                    self.assertAlmostEqual(y * motion["unit"], expected[1], delta=TOLERANCE)
                    self.assertLess(abs(turns(angle * motion["angle_unit"] - expected[2])), TOLERANCE)
                    compared += 1
        self.assertGreater(compared, 500)

    def test_observed_points_are_where_the_table_says(self):
        compared = 0
        for _, _, data, table in self.each():
            motion = data["motion"]
            rows = [table["time"].index(t) for t in motion["time"]]
            for mark in motion["marks"]:
                if mark["type"] != "observe":
                    continue
                for frame, row in enumerate(rows):
                    for c, axis in enumerate("xy"):
                        place = mark["at"][3 * frame + c] * motion["unit"]
                        self.assertAlmostEqual(place, table[mark["name"] + "_" + axis][row],
                                               delta=TOLERANCE)
                        compared += 1
        self.assertGreater(compared, 50)

    def test_the_free_end_has_its_deflection(self):
        compared = 0
        for _, _, data, table in self.each():
            motion = data["motion"]
            rows = [table["time"].index(t) for t in motion["time"]]
            hubs = [body for body in motion["bodies"] if body["kind"] == "hub"]
            for body in motion["bodies"]:
                if body["name"] + ".tip_deflection" not in table or len(hubs) != 1:
                    continue
                middle = 2 * (body["along"] * (body["across"] + 1) + body["across"] // 2)
                for frame, row in enumerate(rows):
                    pose = hubs[0]["poses"][3 * frame:3 * frame + 3]
                    angle = pose[2] * motion["angle_unit"]
                    tip = body["points"][frame][middle:middle + 2]
                    across = (-math.sin(angle) * (tip[0] - pose[0]) +
                              math.cos(angle) * (tip[1] - pose[1])) * motion["unit"]
                    self.assertAlmostEqual(across, table[body["name"] + ".tip_deflection"][row],
                                           delta=TOLERANCE)
                    compared += 1
        self.assertGreater(compared, 50)

    def test_pages_need_no_other_file(self):
        for folder, page, _, _ in self.each():
            references = references_of(page)
            self.assertGreater(len(references), 10)
            for tag, name, value in references:
                if value.startswith(("#", "data:")):
                    continue
                self.assertEqual((tag, name), ("a", "href"), value)
                self.assertNotIn(":", value)
                self.assertTrue(os.path.isfile(folder + "/" + value), value)
            style = page[page.index("<style>"):page.index("</style>")]
            self.assertFalse("url(" in style)
            self.assertFalse("@import" in style)
            self.assertFalse("sourceMappingURL" in page)

    def test_designs_are_in_the_page(self):
        folder, page, data, _ = self.runs["four_bar"]
        self.assertGreater(len(data["designs"]["rocker"]["rings"]), 0)
        self.assertEqual(len(data["iterations"][0]["components"]), 2)
        self.assertIn("uniform", data)
        for file in ("design.dxf", "design.step", "run.json", "case.toml"):
            self.assertTrue('href="%s"' % file in page, file)


if __name__ == "__main__":
    unittest.main()
