"""A fit over windows carried on to its end."""

from __future__ import annotations

from greybox_torch.diagnosis.settings import SearchBudget
from greybox_torch.estimate.carried_starts import carried_starts
from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.window_fit import WindowFit, fit_windows
from greybox_torch.simulation.simulator import Simulator


def continued(fit: WindowFit, simulator: Simulator, length: int, limits: Settings, budget: SearchBudget) -> WindowFit:
    """The fit carried on to the end; where states are carried, in turns with bringing those along anew, while that gains anything."""
    for _ in range(budget.most_turns):
        along = fit.along
        starts = carried_starts(fit.problem, simulator, fit.windows, fit.starts) if along is None else along
        again = fit_windows(
            fit.problem,
            simulator,
            length,
            starts=starts,
            settings=limits,
            damping=fit.damping,
            carried=True,
            known=fit.known(simulator, starts),
        )
        if again is None or again.mean_square > fit.mean_square:
            break
        gained, fit = again.mean_square < (1 - budget.least_turn_gain) * fit.mean_square, again
        if not (gained and fit.problem.carried.any()):
            break
    return fit
