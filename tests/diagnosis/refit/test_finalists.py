"""Which of the candidates that were tried are refitted in full."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.refit.finalists import Trial, finalists, leading_and_rest
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.mechanisms.actuator import InputDelay, InputLag
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import ViscousFriction
from greybox_torch.mechanisms.sensor import OutputDelay, SensorLag


@pytest.mark.parametrize(("behind", "chosen"), [(0.02, True), (0.5, False)])
def test_what_is_akin_to_a_finalist_and_ties_with_it_is_one_too(dead_zone_search, behind: float, chosen: bool) -> None:
    """Seen: lags of the input and of the output behind two dead times; that of the input, refitted alone, was told for the other."""
    study, model = dead_zone_search.study, dead_zone_search.problem.model
    laws = [
        (-2.1, attach(model, "actuator", InputDelay())),
        (-2.0, attach(model, "sensor", OutputDelay())),
        (-1.3, attach(model, "actuator", InputLag())),
        (-1.3 + behind, attach(model, "sensor", SensorLag())),
        (-1.2 + behind, attach(model, "rotor", ViscousFriction())),
    ]
    plain = dead_zone_search.state.current
    trials: list[Trial] = [(gain, Candidate(law, (), 0.5), plain, plain.simulator) for gain, law in laws]
    names = [candidate.attachment.mechanism.name for _, candidate, *_ in finalists(trials, study)]
    assert names == ["input_delay", "output_delay", "input_lag", *(["sensor_lag"] if chosen else [])]


def test_twins_go_together_however_their_trials_ended(dead_zone_search) -> None:
    """Seen: 20 ms that pass in a servo, told as a lag or a delay of its output, though it is the command that is late."""
    study, model = dead_zone_search.study, dead_zone_search.problem.model
    laws = [
        (-2.1, attach(model, "sensor", SensorLag())),
        (-2.0, attach(model, "sensor", OutputDelay())),
        *((-1.3, attach(model, "rotor", ViscousFriction())) for _ in range(study.budget.finalists)),
        (-0.1, attach(model, "actuator", InputDelay())),
    ]
    plain = dead_zone_search.state.current
    trials: list[Trial] = [(gain, Candidate(law, (), 0.5), plain, plain.simulator) for gain, law in laws]
    chosen = finalists(trials, study)
    assert trials[-1] in chosen and trials[-1] in leading_and_rest(study, chosen)[0]
