"""Further start values of a law's shape, where several explain alike."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.refit.restarts import restarts
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import AdditionalMode
from greybox_torch.mechanisms.mechanism import Probe

SETTINGS, BUDGET = DiagnosisSettings(), SearchBudget()


def test_shapes_that_explain_alike_are_tried_from_end_to_end(motor_data, motor, begun) -> None:
    """Seen: a mode whose own frequency lay between two probes; all above it explained as much, as mere inertia."""
    search = begun(motor_data(noise=0.1), motor)
    mode = attach(motor, "rotor", AdditionalMode())
    shares = {1.0: 0.1, 2.0: 0.2, 4.0: 0.44, 8.0: 0.443, 16.0: 0.442, 32.0: 0.442, 64.0: 0.442}
    looks = [[ScreenScore(mode, Probe(("mass",), {"omega": w}), 31, share, np.ones(1)) for w, share in shares.items()]]
    ranked = judged(Candidate(mode, (), 0.443), search.plain, search.plain, SETTINGS)
    tried = [start[f"{mode.prefix}.omega"] for start in restarts(search.study, looks, ranked)]
    assert tried == [4.0, 16.0, 64.0]
    looks[0][3] = ScreenScore(mode, Probe(("mass",), {"omega": 8.0}), 31, 0.9, np.ones(1))
    assert restarts(search.study, looks, ranked)[0][f"{mode.prefix}.omega"] == 8.0


def test_what_was_not_screened_has_no_further_shapes(motor, motor_data, begun) -> None:
    """A law that a learned curve suggested."""
    search = begun(motor_data(noise=0.1), motor)
    ranked = judged(Candidate(attach(motor, "rotor", AdditionalMode()), (), 0.4), search.plain, search.plain, SETTINGS)
    assert restarts(search.study, [[]], ranked) == []
