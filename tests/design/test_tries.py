"""How many inputs a search tries."""

from __future__ import annotations

import pytest

from greybox_torch.experiment_design.search import DRAWN, KEPT, MOST_SAMPLES, MOST_TRIED, VARIED, tries


@pytest.mark.parametrize("samples", [16, 700, MOST_TRIED // DRAWN])
def test_of_usual_recordings_all(samples: int) -> None:
    assert tries(samples) == (DRAWN, VARIED)


def test_of_long_ones_fewer_but_enough_to_choose_from() -> None:
    for samples in (5_000, MOST_SAMPLES):
        tried, varied = tries(samples)
        assert KEPT <= varied < VARIED and 2 * KEPT <= tried < DRAWN
        assert tried * samples <= max(MOST_TRIED, 2 * KEPT * samples)
