"""Shows pages of studies, of the command `report`, and of a run that goes on.

    python3 study_page_test.py PROGRAM
"""

import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from page_data import data_of, references_of

PROGRAM = sys.argv.pop(1)
REFRESH = 'http-equiv="refresh"'
SMALL = ["design.cell=0.1", "design.min_thickness=0.1", "optimizer.max_iterations=3", "expect=",
         "output.vtk=false"]


def flexmorph(*words):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True)


def options(changes):
    return [word for change in changes for word in ("--set", change)]


def text_of(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


class StudyPages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.sweep = cls.scratch.name + "/sweep"
        cls.ended = flexmorph("sweep", "short_beam", "--vary", "design.max_volume=0.3,0.5",
                              "-o", cls.sweep, "--quiet", *options(SMALL))
        cls.runs = [cls.sweep + "/max_volume=" + v for v in ("0.3", "0.5")]

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def check_references(self, page, folder):
        """Everything that a page refers to is an anchor, or a page of a run that exists."""
        links = []
        for tag, name, value in references_of(page):
            if value.startswith(("#", "data:")):
                continue
            self.assertEqual((tag, name), ("a", "href"), value)
            self.assertTrue(os.path.isfile(folder + "/" + value), value)
            links.append(value)
        return links

    def test_a_sweep_shows_its_designs_and_links_to_its_runs(self):
        page = text_of(self.sweep + "/sweep.html")
        links = self.check_references(page, self.sweep)
        self.assertEqual(len(links), 2, self.ended.stderr)
        self.assertEqual(page.count('class="design thumbnail"><svg'), 2)
        self.assertFalse(REFRESH in page)
        curves = data_of(page)["plots"]["convergence"]["panels"][0]["curves"]
        self.assertEqual([len(curve["y"]) for curve in curves], [3, 3])

    def test_thumbnails_are_smaller_than_their_drawings(self):
        page = text_of(self.sweep + "/sweep.html")
        begin = page.index('class="design thumbnail"')
        size = page.index("</svg>", begin) - begin
        self.assertLess(size, len(text_of(self.runs[0] + "/design.svg")))

    def test_runs_are_compared(self):
        path = self.scratch.name + "/both.html"
        ended = flexmorph("report", *self.runs, "-o", path)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        page = text_of(path)
        self.assertEqual(len(self.check_references(page, self.scratch.name)), 2)
        self.assertTrue("<td>design.max_volume</td>" in page, "the setting that differs")
        self.assertTrue("crisp compliance [J]" in page)
        self.assertEqual(len(data_of(page)["plots"]["convergence"]["panels"][0]["curves"]), 2)

    def test_a_folder_without_a_run_is_refused(self):
        ended = flexmorph("report", self.scratch.name, "-o", self.scratch.name + "/none.html")
        self.assertEqual(ended.returncode, 2)
        self.assertIn(self.scratch.name, ended.stderr)
        self.assertFalse(os.path.exists(self.scratch.name + "/none.html"))

    def test_a_comparison_of_optimizers_has_a_page(self):
        folder = self.scratch.name + "/compare"
        flexmorph("compare", "short_beam", "--optimizers", "mma,gcmma", "--starts", "1",
                  "-o", folder, "--quiet",
                  *options(SMALL))
        page = text_of(folder + "/compare.html")
        self.assertEqual(len(self.check_references(page, folder)), 2)
        self.assertTrue("gcmma" in page)
        self.assertIn("comparison", data_of(page)["plots"])


class LivePages(unittest.TestCase):
    def test_the_page_of_a_run_that_goes_on_refreshes_itself_until_the_end(self):
        with tempfile.TemporaryDirectory() as folder:
            page = folder + "/run/report.html"
            run = subprocess.Popen([PROGRAM, "run", "four_bar", "-o", folder + "/run", "--quiet"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                for _ in range(1200):
                    if os.path.exists(page):
                        break
                    time.sleep(0.05)
                live = text_of(page)
                self.assertTrue(REFRESH in live)
                self.assertTrue("running" in live)
                run.send_signal(signal.SIGINT)
                self.assertEqual(run.wait(timeout=60), 4)
            finally:
                run.kill()
                run.wait()
            self.assertFalse(REFRESH in text_of(page))


if __name__ == "__main__":
    unittest.main()
