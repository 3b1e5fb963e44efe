"""A model of another command that is going to be replaced is warned of once, also where it came meanwhile."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest

from greybox_torch.commands.results_folder import Replacing, others_model


def finish_elsewhere(folder: Path) -> None:
    """As another process leaves the results of a diagnosis."""
    for name in ("model.json", "verdict.json"):
        (folder / name).write_text("{}")


@pytest.mark.parametrize("when", ["before", "meanwhile", "never"])
def test_a_model_that_another_process_wrote_is_warned_of_once(
    tmp_path: Path, capsys: pytest.CaptureFixture, when: str
) -> None:
    """Seen: a fit that ended after a diagnosis in the same folder, fit.json of the one and model.json of the other."""
    replacing, heard = Replacing(partial(others_model, tmp_path, "fit")), []
    tell = replacing.before(heard.append)
    if when == "before":
        finish_elsewhere(tmp_path)
    tell("fitting")
    if when == "meanwhile":
        finish_elsewhere(tmp_path)
    tell("polishing")
    replacing.warn()
    replacing.warn()
    said = capsys.readouterr().err
    assert said.count("holds results of greybox diagnose (verdict.json)") == (when != "never")
    assert heard == ["fitting", "polishing"]
