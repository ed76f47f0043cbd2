"""Cases, motions, runs and results of the Python package."""

import pathlib
import tempfile
import unittest

import numpy as np

import flexmorph
import support


class Loading(unittest.TestCase):
    def test_errors_have_file_line_and_key(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "bad.toml"
            path.write_text('title = "Bad"\n[domain]\nsize = [2.0, 1.0]\nthickness = -1.0\n')
            with self.assertRaises(flexmorph.InputError) as caught:
                flexmorph.load(path)
        self.assertEqual(caught.exception.file, str(path))
        self.assertEqual((caught.exception.line, caught.exception.key), (4, "domain.thickness"))
        self.assertIsInstance(caught.exception, (flexmorph.Error, ValueError))

    def test_a_changed_key_is_named(self):
        with self.assertRaises(flexmorph.InputError) as caught:
            flexmorph.load("short_beam", set={"design.max_volume": -0.4})
        self.assertEqual(caught.exception.key, "design.max_volume")

    def test_changes_reach_the_case(self):
        case = flexmorph.load("short_beam", set={"design.max_volume": 0.25, "title": "A \"beam\""})
        self.assertEqual(case.title, 'A "beam"')
        self.assertIn("max_volume = 0.25", case.text)
        self.assertIn("beam", case.check())

    def test_a_dictionary_equals_a_file(self):
        case = flexmorph.load(support.PENDULUM, name="pendulum")
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "pendulum.toml"
            path.write_text(case.text)
            again = flexmorph.load(path)
        self.assertEqual(case.name, "pendulum")
        first, second = case.motion(), again.motion()
        for name in first:
            np.testing.assert_array_equal(first[name], second[name])

    def test_an_unknown_case_is_an_input_error(self):
        with self.assertRaises(flexmorph.InputError):
            flexmorph.load("no_such_case")


class Motions(unittest.TestCase):
    def test_energy_of_a_pendulum(self):
        table = flexmorph.load(support.PENDULUM).motion()
        self.assertEqual(table.units["time"], "s")
        self.assertEqual(table.n_rows, 501)
        # Kinetic energy equals the lost potential energy to the order of the scheme: the error of
        # the velocity is of the size (w h)^2 = 5e-5 for the frequency w = 7 1/s and h = 1e-3 s.
        gained = table["energy.kinetic"] - table["energy.kinetic"][0]
        lost = table["energy.potential"][0] - table["energy.potential"]
        np.testing.assert_allclose(gained, lost, rtol=0, atol=1e-4 * lost.max())

    def test_tables_own_their_data(self):
        case = flexmorph.load(support.PENDULUM)
        first = case.motion()
        first["time"][:] = -1
        self.assertEqual(case.motion()["time"][1], 1e-3)


class Runs(unittest.TestCase):
    def test_files_equal_those_of_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            program, python = pathlib.Path(folder) / "program", pathlib.Path(folder) / "python"
            kernel = support.run_program(program, support.SHORT_PLATE)["blas_kernel"]
            support.run_python("import flexmorph, sys; flexmorph.load(sys.argv[1]).run(sys.argv[2])",
                               kernel, support.SHORT_PLATE, python)
            first, second = support.contents(program), support.contents(python)
        self.assertEqual(sorted(first), sorted(second))
        for name in first:
            self.assertEqual(first[name], second[name], name)

    def test_a_folder_gives_the_results_of_memory(self):
        case = flexmorph.load("short_beam", set=support.SMALL_BEAM)
        messages = []
        with tempfile.TemporaryDirectory() as folder:
            read = case.run(pathlib.Path(folder) / "run", progress=messages.append)
            run = case.run()
            self.assertEqual(read.status, run.status)
            self.assertTrue(any("iteration 1 of at most" in each for each in messages))
            np.testing.assert_array_equal(read.designs["beam"].components,
                                          run.designs["beam"].components)
            np.testing.assert_array_equal(read.designs["beam"].density, run.designs["beam"].density)
            self.assertEqual(support.without_times(read.designs["beam"].results),
                             support.without_times(run.designs["beam"].results))
            for name in run.history:
                np.testing.assert_array_equal(read.history[name], run.history[name], name)
            self.assertEqual(run.history.units["compliance"], "J")

    def test_fields_and_outlines_agree(self):
        design = flexmorph.load("short_beam", set=support.SMALL_BEAM).run().designs["beam"]
        cell = np.outer(np.diff(design.y), np.diff(design.x))
        area = 0.0
        for outer, holes in design.outline:
            for ring in (outer, *holes):
                x, y = ring.T
                area += 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
        # Both are areas of the part: cells by exact fractions, polygons to 0.01 cells.
        self.assertAlmostEqual(np.sum(cell * design.density), area, delta=2e-3 * area)
        self.assertEqual(design.quads.shape[0], design.density.size)
        self.assertEqual(design.quads.max() + 1, len(design.points))

    def test_pandas_and_meshio_take_results(self):
        run = flexmorph.load("short_beam", set=support.SMALL_BEAM).run()
        design = run.designs["beam"]
        for name in ("pandas", "meshio"):
            try:
                module = __import__(name)
            except ImportError:
                continue
            with self.subTest(name):
                if name == "pandas":
                    frame = module.DataFrame(run.history)
                    self.assertEqual(list(frame.columns), run.history.columns)
                    self.assertEqual(len(frame), run.history.n_rows)
                else:
                    mesh = module.Mesh(design.points, [("quad", design.quads)],
                                       cell_data={"density": [design.density.ravel()]})
                    self.assertEqual(mesh.cells[0].data.shape, (design.density.size, 4))

    def test_a_callback_sees_and_stops(self):
        rows = []
        case = flexmorph.load("short_beam", set=support.SMALL_BEAM)
        run = case.run(callback=lambda row: rows.append(row) or row["iteration"] == 2)
        self.assertEqual(run.status, "interrupted")
        self.assertEqual([row["iteration"] for row in rows], [1, 2])
        self.assertEqual(rows[0]["x"].size % 7, 0)

    def test_an_exception_of_a_callback_ends_the_run(self):
        class Own(Exception):
            pass

        def raises(_):
            raise Own("mine")
        case = flexmorph.load("short_beam", set=support.SMALL_BEAM)
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaises(Own):
                case.run(pathlib.Path(folder) / "run", callback=raises)
            run = flexmorph.read(pathlib.Path(folder) / "run")
        self.assertEqual(run.status, "failed")
        with self.assertRaises(Own):
            case.run(callback=raises)

    def test_a_second_run_has_equal_bits(self):
        case = flexmorph.load("short_beam", set=support.SMALL_BEAM)
        first, second = case.run(), case.run()
        for name in first.history:
            np.testing.assert_array_equal(first.history[name], second.history[name])
        fresh = support.run_python(
            "import flexmorph, sys; c = flexmorph.load('short_beam', set=eval(sys.argv[1]));"
            "print(c.run().designs['beam'].components.tobytes().hex())",
            flexmorph.build_info()["blas_kernel"], support.SMALL_BEAM)
        self.assertEqual(fresh.strip(), second.designs["beam"].components.tobytes().hex())


if __name__ == "__main__":
    unittest.main()
