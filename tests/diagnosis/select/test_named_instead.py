"""How many names may stand for a free curve."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.select.forward import _in_pieces
from greybox_torch.diagnosis.settings import DiagnosisSettings


@pytest.mark.parametrize(
    ("ports", "pieces"),
    [(["pivot", "pivot"], False), (["pivot", "pivot", "arm"], False), (["pivot", "pivot", "pivot"], True)],
)
def test_more_than_two_names_at_the_place_of_a_curve_are_pieces_of_it(stub, ports, pieces) -> None:
    """Seen: a slack spring, outside the library, told as gravity, a stop, a bias and a ripple at the pivot."""
    before, added = stub(port="pivot"), [stub(port=port) for port in ports]
    taken = stub(candidate=stub(attachment=stub(port="pivot")))
    with_curve = stub(steps=(stub(parent=stub(effects=(before,)), taken=taken),))
    branch = stub(effects=(before, *added))
    assert _in_pieces(stub(settings=DiagnosisSettings()), with_curve, branch) is pieces  # type: ignore[arg-type]
