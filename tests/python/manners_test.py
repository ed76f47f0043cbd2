"""Behaviour of the package in a process that belongs to others."""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import flexmorph
import support

# Runs the short beam into a folder; says when the first iteration is over, and how it ended.
INTERRUPTED = """
import flexmorph, sys, time
def callback(row):
    print("iteration", flush=True)
    time.sleep(0.05)
case = flexmorph.load("short_beam", set={"design.cell": 0.05,
                                         "design.min_thickness": 0.05,
                                         "output.plots": False, "output.vtk": False})
try:
    case.run(sys.argv[1], callback=callback)
except KeyboardInterrupt:
    print("KeyboardInterrupt", flexmorph.read(sys.argv[1]).status)
"""

PACKAGES = ("numpy", "scipy.optimize", "mpi4py.MPI", "nlopt", "flexmorph")


class Signals(unittest.TestCase):
    def test_ctrl_c_stops_with_whole_files(self):
        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.Popen([sys.executable, "-c", INTERRUPTED, os.path.join(folder, "run")],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   stdin=subprocess.DEVNULL, text=True,
                                   preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
            try:
                self.assertEqual(run.stdout.readline(), "iteration\n")
                run.send_signal(signal.SIGINT)
                out, errors = run.communicate(timeout=100)  # other processes may use the processor
            finally:
                run.kill()
                run.wait()
            self.assertEqual(out.splitlines()[-1:], ["KeyboardInterrupt interrupted"],
                             f"exit code {run.returncode}: {errors}")
            names = os.listdir(os.path.join(folder, "run"))
            self.assertIn("history.csv", names)
            self.assertFalse([n for n in names if n.endswith(".tmp")])

    def test_import_changes_no_handlers_and_no_environment(self):
        script = ("import os, signal\n"
                  "before = dict(os.environ), [signal.getsignal(s) for s in range(1, 32)]\n"
                  "raw = open('/proc/self/environ', 'rb').read()\n"
                  "import flexmorph\n"
                  "c = flexmorph.load('short_beam')\n"
                  "assert raw == open('/proc/self/environ', 'rb').read()\n"
                  "assert before == (dict(os.environ), [signal.getsignal(s) for s in range(1, 32)])")
        support.run_python(script, flexmorph.build_info()["blas_kernel"])

    def test_the_lock_of_the_interpreter_is_released(self):
        # Another thread of Python counts while a motion is computed.
        import threading
        case, count, running = flexmorph.load(support.PENDULUM), [0], [True]

        def counts():
            while running[0]:
                count[0] += 1
                time.sleep(1e-3)
        thread = threading.Thread(target=counts)
        thread.start()
        before = count[0]
        case.motion()
        after = count[0]
        running[0] = False
        thread.join()
        self.assertGreater(after, before)


class Imports(unittest.TestCase):
    def test_orders_of_imports(self):
        available = []
        for name in PACKAGES:
            try:
                __import__(name)
                available.append(name)
            except ImportError:
                pass
        script = ("import importlib, sys\n"
                  "for name in sys.argv[1:]: importlib.import_module(name)\n"
                  "import flexmorph\n"
                  "p = flexmorph.load('short_beam', set={'design.cell': 0.1,"
                  " 'design.min_thickness': 0.1}).problem(stage='coarse')\n"
                  "s = p.solve('ipopt', stages=False, max_iterations=3)\n"
                  "print(s.x.tobytes().hex())")
        kernel = flexmorph.build_info()["blas_kernel"]
        alone = support.run_python(script, kernel)
        for order in (available, available[::-1], ["flexmorph", *available[:-1]]):
            self.assertEqual(support.run_python(script, kernel, *order), alone, order)


if __name__ == "__main__":
    unittest.main()
