"""Design problems of the Python package: gradients, adapters, solutions."""

import pathlib
import tempfile
import unittest

import numpy as np

import flexmorph
import support

SHORT_FOUR_BAR = {"time.end": 0.06, "time.step": 2e-3, "esl.every": 0.02, "design.cell": 0.01,
                  "design.min_thickness": 0.01, "design.components": [4, 2],
                  "design.half_length": 0.05}
COARSE = {"design.cell": 0.05, "design.min_thickness": 0.05}


def direction_of(problem, seed):
    """Return a design inside the bounds without symmetry, and a direction of unit size."""
    random = np.random.default_rng(seed)
    d = random.standard_normal(problem.n)
    x = problem.x0 + 0.05 * random.uniform(-1, 1, problem.n)
    return np.clip(x, problem.lower + 0.02, problem.upper - 0.02), d / np.max(np.abs(d))


class Gradients(unittest.TestCase):
    def check(self, problem, steps, seed=1):
        x, d = direction_of(problem, seed)
        for function, gradient in ((problem.objective, problem.gradient),
                                   (problem.constraints, problem.jacobian)):
            orders = support.taylor_orders(function, gradient, x, d, steps)
            for order in orders[-3:]:
                self.assertAlmostEqual(order, 2.0, delta=0.05, msg=str(orders))

    def test_short_beam(self):
        problem = flexmorph.load("short_beam").problem(stage="coarse")
        self.check(problem, [1e-4 / 2 ** k for k in range(5)])

    def test_last_stage(self):
        # The limit on the crisp volume, which jumps with the grid, is made differentiable. Gradients of
        # widths are approximate.
        problem = flexmorph.load("short_beam", set=COARSE).problem()
        x, d = direction_of(problem, 1)
        at = problem.constraint_names.index("volume")
        orders = support.taylor_orders(lambda y: problem.constraints(y)[at],
                                       lambda y: problem.jacobian(y)[at], x, d,
                                       [1e-3 / 2 ** k for k in range(4)])
        for order in orders:
            self.assertAlmostEqual(order, 2.0, delta=0.05, msg=str(orders))
        # A problem that starts at x has the crisp volume of x, except for its finished corners.
        again, crisp = problem.at("last", x), problem.crisp(x)["beam"]["volume"] / 0.4 - 1
        self.assertAlmostEqual(again.constraints(x)[at], crisp, delta=1e-2)
        self.assertGreater(abs(again.constraints(x)[at] - problem.constraints(x)[at]), 1e-5)

    def test_short_plate(self):
        problem = flexmorph.load(support.SHORT_PLATE).problem("plate")
        self.assertEqual(problem.bodies, ["plate"])
        self.check(problem, [1e-4 / 2 ** k for k in range(5)])

    def test_four_bar_under_loads_and_in_motion(self):
        case = flexmorph.load("four_bar", set=SHORT_FOUR_BAR)
        loads, motion = case.problem(stage="coarse"), case.problem(of="motion", stage="coarse")
        self.check(loads, [4e-3 / 2 ** k for k in range(6)])
        self.check(motion, [4e-3 / 2 ** k for k in range(6)])
        self.assertNotEqual(loads.objective(loads.x0), motion.objective(motion.x0))
        found = motion.solve("mma", max_iterations=3)
        self.assertEqual(found.nit, 3)
        self.assertFalse(hasattr(found, "absent"))
        self.assertEqual(found.fun, motion.objective(found.x))

    def test_limits_of_the_motion(self):
        for response in ("joint_force", "deflection"):
            case = flexmorph.load(support.SHORT_PLATE, set={
                "time.end": 0.06, "esl.every": 0.02, "design.cell": 0.01,
                "design.min_thickness": 0.01, "cycle.correct": "direct", "design.max_volume": None,
                "design.constraint": [{"response": "volume", "at_most": 0.5},
                                      {"response": response, "at_most": 1.0}]})
            problem = case.problem(of="motion", stage="coarse", step=2e-3)
            at = problem.constraint_names.index(response)
            x, d = direction_of(problem, 1)
            orders = support.taylor_orders(lambda y: problem.constraints(y)[at],
                                           lambda y: problem.jacobian(y)[at], x, d,
                                           [1e-3 / 2 ** k for k in range(4)])
            for order in orders:
                self.assertAlmostEqual(order, 2.0, delta=0.05, msg=f"{response}: {orders}")

    def test_hessian_of_the_short_beam(self):
        problem = flexmorph.load("short_beam", set=COARSE).problem(stage="coarse")
        self.assertTrue(problem.has_hessian)
        x, d = direction_of(problem, 0)
        weights = np.linspace(1.0, 2.0, problem.m)

        def lagrangian(y):
            e = problem.evaluate(y)
            return 0.5 * e.f + weights @ e.g

        e = problem.evaluate(x)
        slope = (0.5 * e.df + weights @ e.dg) @ d
        bend = d @ problem.hessian_matrix(x, weights, 0.5) @ d
        steps = [1.25e-3 / 2 ** k for k in range(5)]
        errors = [abs(lagrangian(x + h * d) - lagrangian(x) - h * slope - 0.5 * h * h * bend)
                  for h in steps]
        orders = np.log2(np.array(errors[:-1]) / errors[1:])
        for order in orders[-3:]:
            self.assertAlmostEqual(order, 3.0, delta=0.05, msg=str(orders))
        lower = problem.hessian(x, weights, 0.5)
        rows, columns = problem.hessianstructure()
        np.testing.assert_array_equal(problem.hessian_matrix(x, weights, 0.5)[rows, columns], lower)


class Interfaces(unittest.TestCase):
    def setUp(self):
        self.problem = flexmorph.load("short_beam", set=COARSE).problem(stage="coarse")

    def test_shapes_and_names(self):
        p = self.problem
        self.assertEqual((len(p.names), len(p.constraint_names)), (p.n, p.m))
        self.assertEqual(p.names[3], "beam.1.angle")
        e = p.evaluate(p.x0)
        self.assertEqual((e.df.shape, e.g.shape, e.dg.shape), ((p.n,), (p.m,), (p.m, p.n)))
        self.assertTrue(np.all(p.lower <= p.x0) and np.all(p.x0 <= p.upper))

    def test_one_evaluation_serves_all_functions(self):
        p = self.problem
        before = p.evaluations
        for function in (p.objective, p.gradient, p.constraints, p.jacobian):
            function(p.x0)
        self.assertEqual(p.evaluations, before + 1)
        p.objective(p.x0 + 1e-9)
        self.assertEqual(p.evaluations, before + 2)

    def test_results_are_copies(self):
        p = self.problem
        p.gradient(p.x0)[:] = 0
        self.assertGreater(np.abs(p.gradient(p.x0)).max(), 0)

    def test_no_hessian_says_why(self):
        p = flexmorph.load("short_beam", set=COARSE).problem()
        self.assertFalse(p.has_hessian)
        self.assertFalse(hasattr(p, "hessian"))
        with self.assertRaises(flexmorph.NoHessian):
            p.hessian_matrix(p.x0, np.zeros(p.m))
        self.assertTrue(any(name.startswith("width") for name in p.constraint_names))

    def test_wrong_arguments(self):
        with self.assertRaises(ValueError):
            self.problem.objective(np.zeros(3))
        with self.assertRaises(flexmorph.InputError):
            flexmorph.load("short_beam").problem("no_such_body")
        with self.assertRaises(flexmorph.InputError):
            flexmorph.load("short_beam").problem(of="motion")

    def test_scipy_decreases_the_objective(self):
        try:
            from scipy.optimize import minimize
        except ImportError:
            self.skipTest("SciPy is absent")
        p = self.problem
        for method, options in (("SLSQP", {"maxiter": 10}),
                                ("trust-constr", {"maxiter": 20, "initial_tr_radius": 0.5,
                                                  "initial_barrier_parameter": 1e-3,
                                                  "initial_barrier_tolerance": 1e-3})):
            x = p.x0
            for _ in range(6):
                x = minimize(**p.scipy(x, box=0.15), method=method, options=options).x
            self.assertLess(p.constraints(x).max(), 1e-2, method)
            self.assertLess(p.objective(x), p.objective(p.x0) - 0.3, method)

    def test_boxes_lie_inside_the_bounds(self):
        p = self.problem
        lower, upper = p.box(p.x0, 0.15)
        self.assertTrue(np.all(p.lower <= lower) and np.all(upper <= p.upper))
        self.assertLessEqual((upper - lower).max(), 0.3 + 1e-12)
        np.testing.assert_array_equal(p.box(p.x0, 1e3)[0], p.lower)

    def test_scipy_gets_infinite_values_where_nothing_can_be_evaluated(self):
        try:
            arguments = self.problem.scipy()
        except ImportError:
            self.skipTest("SciPy is absent")
        x = self.problem.x0
        x[self.problem.names.index("beam.1.half_length")] = -1.0  # outside the bounds
        with self.assertRaises(flexmorph.NumericalError):
            self.problem.objective(x)
        self.assertEqual(arguments["fun"](x), np.inf)
        self.assertTrue(np.all(np.isinf(arguments["constraints"].fun(x))))

    def test_the_object_has_what_cyipopt_calls(self):
        # cyipopt is not in Debian 12; the calls are those of its documentation.
        for stage in ("coarse", "last"):
            p = flexmorph.load("short_beam", set=COARSE).problem(stage=stage)
            arguments = p.cyipopt()
            called = arguments.pop("problem_obj")
            self.assertEqual(sorted(arguments), ["cl", "cu", "lb", "m", "n", "ub"])
            x = np.clip(p.x0, arguments["lb"], arguments["ub"])
            self.assertEqual(np.ndim(called.objective(x)), 0)
            self.assertEqual(called.gradient(x).shape, (p.n,))
            self.assertEqual(called.constraints(x).shape, (p.m,))
            # Without jacobianstructure the matrix is full, row by row.
            self.assertFalse(hasattr(called, "jacobianstructure"))
            self.assertEqual(np.ravel(called.jacobian(x)).size, p.n * p.m)
            self.assertEqual(hasattr(called, "hessian"), stage == "coarse")
            if stage == "last":
                continue
            rows, columns = called.hessianstructure()
            self.assertTrue(np.all(rows >= columns))
            lagrange = np.full(p.m, 2.0)
            lower = np.zeros((p.n, p.n))
            lower[rows, columns] = called.hessian(x, lagrange, 0.5)
            whole = lower + np.tril(lower, -1).T
            np.testing.assert_allclose(whole, p.hessian_matrix(x, lagrange, 0.5), rtol=0, atol=1e-10)

    def test_another_thread_needs_a_problem_of_its_own(self):
        import threading
        p, errors = self.problem, []

        def compute():
            try:
                p.objective(p.x0 + 1e-3)
            except flexmorph.Error as error:
                errors.append(error)

        def callback(_):
            thread = threading.Thread(target=compute)
            thread.start()
            thread.join()
            return True

        p.solve("mma", stages=False, callback=callback)
        self.assertEqual([type(e) for e in errors], [flexmorph.InputError])
        compute()  # when nothing is computed, any thread may begin
        self.assertEqual(len(errors), 1)

    def test_nlopt_decreases_the_objective(self):
        try:
            import nlopt
        except ImportError:
            self.skipTest("NLopt for Python is absent")
        p = self.problem
        x = p.x0
        for _ in range(4):  # boxes that move, because NLopt's first steps are long
            opt = nlopt.opt(nlopt.LD_CCSAQ, p.n)
            lower, upper = p.box(x, 0.075)
            opt.set_lower_bounds(lower)
            opt.set_upper_bounds(upper)
            opt.set_min_objective(p.nlopt)
            opt.add_inequality_mconstraint(p.nlopt_constraints, np.full(p.m, 1e-4))
            opt.set_maxeval(10)
            x = opt.optimize(x)
        self.assertLess(p.constraints(x).max(), 1e-2)
        self.assertLess(p.objective(x), p.objective(p.x0) - 0.2)


class Solutions(unittest.TestCase):
    def test_solve_minimizes(self):
        p = flexmorph.load("short_beam", set=COARSE).problem(stage="coarse")
        rows = []
        found = p.solve("mma", stages=False, callback=rows.append, max_iterations=20)
        self.assertEqual(len(rows), found.nit)
        self.assertLess(found.violation, 1e-4)
        self.assertEqual(found.fun, p.objective(found.x))
        excess = found.designs["beam"].results["volume"] / 0.4 - 1
        self.assertAlmostEqual(found.crisp_violation, excess if excess > 5e-3 else 0, places=12)
        self.assertLess(found.fun, p.objective(p.x0) - 0.3)
        next_stage = p.at("last", found.x)
        np.testing.assert_array_equal(next_stage.designs(next_stage.x0)["beam"].components,
                                      found.designs["beam"].components)

    def test_solve_has_the_bits_of_the_program(self):
        for case, body in ((support.SHORT_PLATE, "plate"), ("short_beam", "beam")):
            changes = [] if body == "plate" else [
                "design.cell=0.1", "design.min_thickness=0.1", "optimizer.max_iterations=8",
                "output.plots=false", "output.vtk=false"]
            with tempfile.TemporaryDirectory() as folder:
                summary = support.run_program(pathlib.Path(folder) / "run", case, changes)
                text = support.run_python(
                    "import flexmorph, sys\n"
                    "case = flexmorph.read(sys.argv[1]).case\n"
                    "d = case.problem(sys.argv[2]).solve('mma').designs[sys.argv[2]]\n"
                    "print(d.components.tobytes().hex(), repr(d.results['compliance']))",
                    summary["blas_kernel"], pathlib.Path(folder) / "run", body)
                run = flexmorph.read(pathlib.Path(folder) / "run")
            bits, compliance = text.split()
            self.assertEqual(bits, run.designs[body].components.tobytes().hex())
            self.assertEqual(float(compliance), run.designs[body].results["compliance"])

    def test_solve_tells_the_violation_of_the_crisp_design(self):
        # After one iteration the bars still fill more than the limit allows.
        p = flexmorph.load("short_beam", set={**COARSE, "design.max_volume": 0.2}).problem()
        for stages in (False, True):
            found = p.solve("mma", stages=stages, max_iterations=1)
            results = found.designs["beam"].results
            excess = results["crisp_volume" if stages else "volume"] / 0.2 - 1
            self.assertGreater(excess, 0.1)
            self.assertAlmostEqual(found.crisp_violation, excess, places=12)

    def test_a_callback_stops(self):
        p = flexmorph.load("short_beam", set=COARSE).problem(stage="coarse")
        # The callback may compute with the problem.
        found = p.solve("mma", stages=False,
                        callback=lambda row: p.objective(row["x"]) == row["fun"]
                        and row["iteration"] == 3)
        self.assertEqual((found.nit, found.status), (3, "observer"))
        for optimizer in ("mma", "nlopt_ccsaq", "ipopt"):
            with self.assertRaises(ZeroDivisionError, msg=optimizer):
                p.solve(optimizer, stages=False, callback=lambda row: 1 / 0)


if __name__ == "__main__":
    unittest.main()
