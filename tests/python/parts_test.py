"""Responses, drives, force elements and optimizers that are functions of Python."""

import copy
import math
import unittest

import numpy as np

import flexmorph
import support

COARSE = {"design.cell": 0.05, "design.min_thickness": 0.05, "domain.density": 1.0}


def with_limit(response, value, stage="coarse"):
    case = flexmorph.load("short_beam", set={
        **COARSE, "design.constraint": [{"response": response, "at_most": value}]})
    return case.problem(stage=stage)


class Responses(unittest.TestCase):
    def test_a_sum_equals_the_response_of_the_library(self):
        def mass(cells):
            unit = cells.density * cells.thickness * cells.area
            return unit * cells.mass.sum(), {"mass": np.full(cells.mass.shape, unit)}

        flexmorph.add_response("own_mass", mass, "kg", linear=True)
        own, known = with_limit("own_mass", 0.8), with_limit("mass", 0.8)
        x = own.x0
        at = own.constraint_names.index("own_mass")
        # A response without the value of the full plate is limited by its logarithm, log(m / limit);
        # the mass of the library by m / limit - 1.
        of_known = known.constraint_names.index("mass")
        ratio = np.exp(own.constraints(x)[at])
        np.testing.assert_allclose(ratio - 1, known.constraints(x)[of_known], rtol=1e-12)
        np.testing.assert_allclose(ratio * own.jacobian(x)[at], known.jacobian(x)[of_known],
                                   rtol=0, atol=1e-12)
        self.assertTrue(own.has_hessian)

    def test_gradient_of_a_nonlinear_response(self):
        def response(cells):
            weight = 1 + cells.x ** 2 + 0.5 * cells.y
            value = np.sum(weight * cells.mass ** 2 * cells.stiffness)
            return value, {"mass": 2 * weight * cells.mass * cells.stiffness,
                           "stiffness": weight * cells.mass ** 2}

        flexmorph.add_response("own_nonlinear", response, "-")
        problem = with_limit("own_nonlinear", 500.0)
        self.assertFalse(problem.has_hessian)
        x = np.clip(problem.x0, problem.lower + 0.01, problem.upper - 0.01)
        d = np.random.default_rng(5).uniform(-1, 1, problem.n)
        orders = support.taylor_orders(problem.constraints, problem.jacobian, x, d,
                                       [1e-3 / 2 ** k for k in range(6)])
        self.assertAlmostEqual(np.median(orders[-3:]), 2.0, delta=0.05, msg=str(orders))

    def test_errors_of_a_response_are_raised(self):
        def fails(cells):
            raise LookupError("mine")

        flexmorph.add_response("own_fails", fails)
        with self.assertRaises(LookupError):
            problem = with_limit("own_fails", 1.0)
            problem.objective(problem.x0)
        # The name keeps the new function.
        flexmorph.add_response("own_fails", lambda cells: (1.0, {"mass": np.zeros(3)}))
        problem = with_limit("own_fails", 1.0)
        with self.assertRaises(ValueError):
            problem.objective(problem.x0)
        for optimizer in ("mma", "nlopt_ccsaq", "ipopt"):
            with self.assertRaises(ValueError):
                problem.solve(optimizer, stages=False)

    def test_a_name_of_the_library_is_refused(self):
        with self.assertRaises(flexmorph.InputError):
            flexmorph.add_response("volume", lambda cells: (1.0, {}))


def driven(drive):
    case = copy.deepcopy(support.PENDULUM)
    case["time"]["end"] = 0.2
    case["drive"] = [{"name": "turn", **drive}]
    case["joint"].append({"type": "angle_drive", "name": "motor", "b": "bar", "angle": "turn"})
    return case


def swing(sin, cos):
    return lambda t: (0.3 * sin(4 * t), 1.2 * cos(4 * t), -4.8 * sin(4 * t))


class Drives(unittest.TestCase):
    def test_a_drive_equals_its_formula(self):
        # The functions of `math` are those of the formula, therefore every column agrees.
        flexmorph.add_drive("own_swing", swing(math.sin, math.cos))
        own = flexmorph.load(driven({"from": "own_swing"})).motion()
        formula = flexmorph.load(driven({"formula": "0.3*sin(4*t)"})).motion()
        self.assertIn("pin.force_x", formula)
        self.assertGreater(np.abs(formula["motor.power"]).max(), 1)
        for name in formula:
            scale = np.abs(formula[name]).max()
            np.testing.assert_allclose(own[name], formula[name], rtol=0, atol=1e-12 * max(scale, 1),
                                       err_msg=name)

    def test_round_off_of_a_drive_reaches_forces_through_the_time_step(self):
        # The sine of NumPy differs from that of `math` by one unit in the last place, e = 6e-17 rad.
        # Positions differ by no more. Accelerations of the time integration have this round-off
        # divided by beta h^2 = 0.3e-6 s^2, and forces the mass of 1 kg times the arm of 0.2 m more.
        flexmorph.add_drive("own_swing_of_numpy", swing(np.sin, np.cos))
        own = flexmorph.load(driven({"from": "own_swing_of_numpy"})).motion()
        formula = flexmorph.load(driven({"formula": "0.3*sin(4*t)"})).motion()
        self.assertLess(np.abs(own["bar.angle"] - formula["bar.angle"]).max(), 1e-15)
        self.assertLess(np.abs(own["pin.force_x"] - formula["pin.force_x"]).max(), 1e-7)

    def test_an_unknown_source_is_an_input_error(self):
        with self.assertRaises(flexmorph.InputError) as caught:
            flexmorph.load(driven({"from": "nothing"}))
        self.assertIn("from", caught.exception.key)

    def test_errors_of_a_drive_are_raised(self):
        def fails(t):
            if t > 0.1:
                raise LookupError("mine")
            return 0.0, 0.0, 0.0

        flexmorph.add_drive("own_late", fails)
        with self.assertRaises(LookupError):
            flexmorph.load(driven({"from": "own_late"})).motion()


def sprung(spring):
    case = copy.deepcopy(support.PENDULUM)
    case["time"]["end"] = 0.2
    case["spring"] = [{"name": "held", "a": "ground", "point_a": [0.4, 0.5], "b": "bar",
                       "point_b": [0.4, 0.0], **spring}]
    return case


class ForceElements(unittest.TestCase):
    def test_a_force_element_equals_the_spring_of_the_library(self):
        k, c, length = 50.0, 0.5, 0.3

        def force(r, v, t):
            size = np.linalg.norm(r)
            e = r / size
            rate = e @ v
            pull = k * (size - length) + c * rate
            across = (np.eye(2) - np.outer(e, e)) / size
            by_r = np.outer(e, k * e + c * (across @ v)) + pull * across
            return -pull * e, -by_r, -c * np.outer(e, e)

        # Orders of the derivatives that the element returns, from differences.
        r, v, d = np.array([0.3, -0.2]), np.array([0.1, 0.4]), np.array([0.6, -0.8])
        for at in (0, 1):
            def along(h, of=0):
                return force(r + h * d * (at == 0), v + h * d * (at == 1), 0.0)[of]
            error = [np.abs(along(h) - along(0.0) - h * along(0.0, 1 + at) @ d).max()
                     for h in (1e-2, 5e-3)]
            if at == 0:
                self.assertAlmostEqual(np.log2(error[0] / error[1]), 2.0, delta=0.05)
            else:
                self.assertLess(error[0], 1e-14)  # the force is linear in the velocity

        flexmorph.add_force_element("own_spring", force)
        own = flexmorph.load(sprung({"type": "own_spring"})).motion()
        known = flexmorph.load(sprung({"type": "linear", "stiffness": k, "damping": c,
                                       "free_length": length})).motion()
        for name in ("bar.angle", "bar.x", "energy.kinetic"):
            if name in known:
                scale = np.abs(known[name]).max()
                np.testing.assert_allclose(own[name], known[name], rtol=0, atol=1e-12 * scale,
                                           err_msg=name)
        self.assertGreater(np.abs(np.diff(known["energy.kinetic"])).max(), 0)


class Optimizers(unittest.TestCase):
    def test_an_optimizer_designs_the_beam(self):
        def descent(search):
            x, step = search.x0, search.options["move_limit"]
            e = search.evaluate(x)

            def total(e):
                return e.f + 10 * np.maximum(e.g, 0).sum()
            while search.iterate(x):
                slope = e.df + 10 * e.dg[e.g > 0].sum(axis=0)
                trial = np.clip(x - step * slope / np.abs(slope).max(), search.lower, search.upper)
                found = search.evaluate(trial)
                if found and total(found) < total(e):
                    x, e = trial, found
                else:
                    step *= 0.5

        flexmorph.add_optimizer("own_descent", descent)
        self.assertIn("own_descent", flexmorph.optimizers())
        problem = flexmorph.load("short_beam", set=COARSE).problem(stage="coarse")
        found = problem.solve("own_descent", stages=False, max_iterations=40)
        self.assertEqual(found.nit, 40)
        self.assertLess(found.violation, 1e-2)
        self.assertLess(found.fun, problem.objective(problem.x0) - 0.2)
        case = flexmorph.load("short_beam", set={**support.SMALL_BEAM,
                                                 "optimizer.name": "own_descent"})
        self.assertTrue(case.run().status.startswith("done"))

    def test_the_last_design_is_known_after_many_trials(self):
        def patience(search):
            x = search.x0
            search.evaluate(x)
            while search.iterate(x):
                for k in range(1, 13):
                    search.evaluate(np.clip(x + 1e-4 * k, search.lower, search.upper))

        flexmorph.add_optimizer("own_patience", patience)
        problem = flexmorph.load("short_beam", set=COARSE).problem(stage="coarse")
        self.assertEqual(problem.solve("own_patience", stages=False, max_iterations=3).nit, 3)

    def test_errors_of_an_optimizer_are_raised(self):
        flexmorph.add_optimizer("own_failure", lambda search: 1 / 0)
        problem = flexmorph.load("short_beam", set=COARSE).problem(stage="coarse")
        with self.assertRaises(ZeroDivisionError):
            problem.solve("own_failure", stages=False)


if __name__ == "__main__":
    unittest.main()
