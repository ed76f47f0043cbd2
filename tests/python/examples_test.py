"""The examples of cases/python/examples run, and their designs are better than their starts."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import support

EXAMPLES = support.HERE.parents[1] / "cases" / "python" / "examples"


def run(name, folder):
    done = subprocess.run([sys.executable, str(EXAMPLES / name)], cwd=folder, text=True,
                          stdin=subprocess.DEVNULL, capture_output=True, timeout=300,
                          env={**os.environ, "MPLBACKEND": "svg"})
    assert done.returncode == 0, done.stderr
    return done.stdout


def needs(test, package):
    try:
        __import__(package)
    except ImportError:
        test.skipTest(f"{package} is absent")


class Examples(unittest.TestCase):
    def test_run_and_plot(self):
        needs(self, "matplotlib")
        with tempfile.TemporaryDirectory() as folder:
            self.assertIn("done", run("run_and_plot.py", folder))
            for name in ("design.svg", "history.svg"):
                self.assertGreater((pathlib.Path(folder) / name).stat().st_size, 1000)

    def test_own_response(self):
        needs(self, "scipy")
        with tempfile.TemporaryDirectory() as folder:
            text = run("own_response.py", folder)
        first, last = map(float, re.search(r"compliance (\S+) -> (\S+)\n", text).groups())
        self.assertLess(last, first)

    def test_own_mma(self):
        needs(self, "scipy")
        with tempfile.TemporaryDirectory() as folder:
            lines = run("own_mma.py", folder).splitlines()
        own, known = ([float(n) for n in re.findall(r"\d+\.\d+", line)] for line in lines)
        # Both are feasible; how good they are is asked by the benchmark.
        self.assertLess(own[1], 0.4 * 1.005)
        self.assertLess(own[0], 1.3 * known[0])


if __name__ == "__main__":
    unittest.main()
