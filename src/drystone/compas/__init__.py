"""Problems of compas_dem as models of drystone, and capacity curves as its results.

    from drystone.compas import solve

    solution = solve(problem, direction=(1.0, 0.0, 0.0))
    solution.curve.peak.load_multiplier
    viewer.add_solution(solution.results)

compas_dem itself is needed where results are made: ``pip install drystone[compas]``.
"""

from drystone.compas.problem import model_of
from drystone.compas.results import results_of
from drystone.compas.solve import Solution, solve

__all__ = ["Solution", "model_of", "results_of", "solve"]
