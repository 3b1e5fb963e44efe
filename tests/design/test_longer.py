"""More time to sharpen a parameter promises no less."""

from __future__ import annotations

import numpy as np

from greybox_torch.api.design import _aim
from greybox_torch.api.hypotheses import hypotheses_of
from greybox_torch.experiment_design import search
from greybox_torch.experiment_design.limits import limits_of


def test_the_best_of_shorter_recordings_is_tried_of_longer_ones(undecided, monkeypatch) -> None:
    """Seen: ± 0.67 of 8 s, ± 0.39 of 4 s, as fewer inputs are tried of a longer recording."""
    monkeypatch.setattr(search, "MOST_TRIED", 1)
    monkeypatch.setattr(search, "SHORTEST", 50)
    aim = _aim(hypotheses_of(undecided), "J", ())
    limits = limits_of(undecided.data, undecided.model, undecided.data.limits, "[limits]")
    time = 0.01 * np.arange(400)
    for seed in range(6):
        short, long = (search.search(aim, limits, time[:n], seed, lambda text: None)[0] for n in (200, 400))
        (continued,) = search._tried(aim, limits, time, [short.candidate])
        assert long.score >= continued.score
    assert search.shorter(400) == [50, 100, 200] and search.shorter(50) == []
