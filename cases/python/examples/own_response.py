"""Minimum compliance with an own response as a constraint, solved by SciPy.

The response is the first moment of the mass about the left edge. The problem is solved in the coarse
formulation, the first stage of a run.
"""
import numpy as np
from scipy.optimize import minimize

import flexmorph


def first_moment(cells):
    """Return the first moment about the left edge [kg m] and its derivative by the mass factors."""
    arm = cells.density * cells.thickness * cells.area * cells.x
    return np.sum(arm * cells.mass), {"mass": arm}


flexmorph.add_response("first_moment", first_moment, unit="kg m", linear=True)
case = flexmorph.load("short_beam", set={
    "domain.density": 1.0,
    "design.cell": 0.05,
    "design.min_thickness": 0.05,
    "design.constraint": [{"response": "first_moment", "at_most": 0.6}],
})
problem = case.problem(stage="coarse")

trace = []
found = minimize(**problem.scipy(), method="SLSQP", options={"maxiter": 40},
                 callback=lambda x: trace.append(problem.objective(x)))

g = dict(zip(problem.constraint_names, problem.constraints(found.x)))
print(f"{found.nit} iterations, log compliance {trace[0]:.3f} -> {found.fun:.3f}")
print("constraints:", {name: round(value, 6) for name, value in g.items()})
design = problem.designs(found.x)["beam"]
print("crisp design:", {name: value for name, value in design.results.items()})
print(f"first moment: {design.results['first_moment']:.4f} of at most 0.6 kg m (full beam: 2.0)")
