"""What is found of a model's structure is found once per object."""

from __future__ import annotations

import gc

from greybox_torch.model import GreyBoxModel
from greybox_torch.model.once_per_model import once_per_model
from greybox_torch.systems import RobotArm


def test_found_once_for_every_object_and_kept_no_longer_than_it() -> None:
    asked: list[int] = []

    @once_per_model
    def states(model: GreyBoxModel) -> int | None:
        asked.append(len(model.states))
        return None  # is an answer too

    first, second = RobotArm(), RobotArm()
    assert [states(first), states(first), states(second)] == [None, None, None]
    assert asked == [5, 5]
    (kept,) = [cell.cell_contents for cell in states.__closure__ or () if hasattr(cell.cell_contents, "keyrefs")]
    del first
    gc.collect()
    assert list(kept) == [second]
