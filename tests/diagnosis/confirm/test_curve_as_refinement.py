"""A free curve beside a larger law draws what that lacks, wherever it is."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.standing import refinements
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.unknown import Unknown


@pytest.mark.parametrize(("small", "told"), [(0.07, False), (0.2, True)])
@pytest.mark.parametrize("port", ["arm", "motor"])
def test_a_small_curve_beside_a_larger_law_is_a_refinement(dead_zone_search, stub, port, small, told) -> None:
    """Seen: a rotor's lag with a curve of the arm that it drives beside it (0.94), 7 % of the mismatch of a real machine."""
    study, friction = dead_zone_search.study, Attachment("arm", CoulombFriction())

    def refined(other: Attachment, sizes: tuple[float, float]) -> bool:
        effects = friction, other
        plain = dead_zone_search.plain
        state = stub(effects=effects, prefixes={e.prefix for e in effects}, plain=plain, current=plain)
        others = stub(times_noise=lambda hypothesis: np.array([1.0]), fits=lambda hypothesis: ())
        by_effect = dict(zip((e.prefix for e in effects), sizes, strict=True))
        return other.prefix in refinements(study, state, others, {}, by_effect)

    curve = Attachment(port, Unknown("speed"))
    assert refined(curve, (0.7, small)) is not told
    assert not refined(curve, (0.0, small)), "the curve is the larger one"
    assert not refined(Attachment("motor", ConstantBias()), (0.7, small)), "a law elsewhere"
