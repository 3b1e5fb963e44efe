"""Estimating: problems (a model, records, which numbers are free), free runs and their scores, fits over windows.

For work on the engine itself, as the experiments do it; :func:`greybox_torch.fit` is what users call.
"""

from greybox_torch.estimate.comparison import Score, compare
from greybox_torch.estimate.fit import Estimation, fit_records
from greybox_torch.estimate.free_run import simulate, visited_states
from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.metrics import fit_percent, root_mean_square
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem, problem_for
from greybox_torch.estimate.shifted_states import shifted_states
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.estimate.surroundings import survey
from greybox_torch.estimate.window_fit import WindowFit, fit_windows

__all__ = [
    "Estimation",
    "Problem",
    "Score",
    "Settings",
    "WindowFit",
    "all_starts_free",
    "compare",
    "fit_percent",
    "fit_records",
    "fit_windows",
    "make_problem",
    "problem_for",
    "root_mean_square",
    "shifted_states",
    "simulate",
    "simulator_for",
    "survey",
    "visited_states",
]
