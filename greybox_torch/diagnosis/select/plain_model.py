"""Where a search begins: the model as it stands, fitted, and where the signals at its ports move."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import most_noise
from greybox_torch.diagnosis.hypothesis.window_errors import window_errors
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.screen.views import views_of
from greybox_torch.diagnosis.select.bent_model import from_the_card, moved_far, narrowed
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study
from greybox_torch.errors import NumericalError
from greybox_torch.estimate.driven_states import driven_states, simulated_driven
from greybox_torch.estimate.reconstruction import Motion, reconstructed
from greybox_torch.estimate.shifted_states import shifted_states
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.estimate.surroundings import surroundings_along
from greybox_torch.estimate.window_fit import WindowFit, states_along


def fit_plain_model(study: Study, begun: WindowFit | None = None) -> tuple[Study, SearchState]:
    """The study with what the fit of the model as it stands shows of its ports, and the state that a search begins from.

    Args:
        begun: the values and start states that it begins from; by default the card's, and what the outputs show.

    Raises:
        NumericalError: it overflows even over short windows, and with any one parameter halved or doubled too.
    """
    study.report("refitting the model as it stands")
    model = study.problem.model
    study = replace(study, motion=_motion(study) if study.motion is None else study.motion)
    views = views_of(study.problem, study.motion)
    starts = [study.card, *([] if isinstance(views, str) else views.starts())]
    plain = fit(study, (), starts if begun is None else [begun.problem.values_by_name], begun)
    if plain is None and (others := _around(study)):
        plain = fit(study, (), others, None)
    if plain is None:
        raise NumericalError(
            f"simulating {model.title}: the simulation overflows even over windows of a 64th of the record; "
            "try start values nearer to the truth, or tighter bounds"
        )
    # Over windows, not along the free run: that runs through a stop that the model lacks, and away with a bias.
    over = plain.fits[min(1, len(plain.fits) - 1)]
    around = surroundings_along(model, over.problem, states_along(over, plain.simulator))
    at_card, ranges = from_the_card(study, plain)
    narrower = around if ranges is None else narrowed(around, ranges, study.settings.bent_travel)
    bent = moved_far(plain.problem, study.settings.bent_parameter)
    study = replace(
        study,
        shifts=shifted_states(model, plain.problem),
        surroundings=narrower,
        at_card=at_card if bent or narrower != around else (),
        bent=bent,
    )
    return study, SearchState(plain, plain)


def _motion(study: Study) -> Motion | str:
    """The motion that the outputs show, states that inputs alone drive as the card has them."""
    problem = study.problem
    if not driven_states(problem.model.plain):
        return reconstructed(problem)
    return reconstructed(problem, simulated_driven(problem, simulator_for(problem, study.options)))


def _around(study: Study) -> list[dict[str, float]]:
    """The card's values with one free parameter halved or doubled at a time, as far as bounds and joint constraints allow.

    For a card that cannot be simulated: a mass matrix that is not positive, say, of two parameters a few per cent off.
    """
    problem, found = study.problem, []
    for k in np.flatnonzero(problem.free):
        for factor in (0.5, 2.0):
            values = problem.values.copy()
            values[k] *= factor
            if (values >= problem.lower).all() and (values <= problem.upper).all() and problem.admissible(values):
                found.append(dict(zip(problem.names, map(float, values), strict=True)))
    return found


def weighted_by_noise(study: Study, state: SearchState) -> Study:
    """The study with the inverse size of the errors of every output over the shortest windows as its weight.

    A noisy sensor must not drown an exact one. This is the maximum-likelihood weighting where the outputs' noises are independent, their
    sizes estimated from a first fit. That tells as well where the noise is less than the recordings show (:func:`most_noise`).
    """
    left = squared_errors(state.plain)
    weights = weights_by(study, left) if len(left) > 1 else study.problem.weights
    most = most_noise(state.plain.fits[0], left, study.settings)
    return replace(study, problem=replace(study.problem, weights=weights, most_noise=most))


def weights_by(study: Study, left: np.ndarray) -> np.ndarray:
    """The weights (n_y,) of outputs of which mean squared errors ``left`` (n_y,), in output units, are left."""
    spread = np.nanstd(study.problem.records.y, axis=1)
    return 1.0 / np.sqrt(left + (1e-4 * spread) ** 2 + 1e-300)


def squared_errors(fitted: Hypothesis) -> np.ndarray:
    """The mean squared errors (n_y,) of a hypothesis over its shortest windows, in output units."""
    return np.nanmean(window_errors(fitted.fits[0], fitted.simulator) ** 2, axis=1)
