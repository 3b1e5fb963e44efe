"""Each recipe: its files are written as the page shows them, the model is checked, and it is estimated as far as the page says."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import greybox_torch as gt
from tests.documentation.pages import PAGES, ROOT

SHARED = ROOT.parent / "shared" / "recordings"
RECORDED = {
    "pendulum": "simple_pendulum",
    "positioning_stage": "emps",
    "double_pendulum": "elsewhere/double_pendulum",
    "tanks": "elsewhere/tanks",
}
SLOW = {"double_pendulum", "positioning_stage"}
"""Recipes whose estimation takes long; they are simulated."""

RECIPES = [Path(page).stem for page in PAGES if page.startswith("docs/recipes/") and not page.endswith("index.md")]
_FILE = re.compile(r'^```\w+ title="([\w.]+)"\n(.*?)^```$', re.M | re.S)


@pytest.fixture(params=RECIPES)
def recipe(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The recipe's files in the present folder, and its recordings."""
    monkeypatch.chdir(tmp_path)
    files = dict(_FILE.findall(PAGES[f"docs/recipes/{request.param}.md"].read_text(encoding="utf-8")))
    for name, text in files.items():
        Path(name).write_text(text, encoding="utf-8")
    if request.param in RECORDED:
        folder = SHARED / RECORDED[request.param]
        if not folder.is_dir():
            pytest.skip(f"the real recordings (../shared/recordings/{RECORDED[request.param]}) are not here")
        for file in folder.iterdir():
            if file.suffix in (".csv", ".mat", ".npz"):
                Path(file.name).symlink_to(file)
    else:
        exec(compile(files["record.py"], "record.py", "exec"), {})
    return request.param


def test_recipe(recipe: str) -> None:
    data = gt.load_dataset("dataset.toml")
    model = gt.load_model(str(data.model))
    assert not gt.check(model).findings
    if recipe in SLOW:
        assert np.isfinite([score["rmse"] for score in gt.simulate(model, data).scores]).all()
        return
    rows = [row for row in gt.fit(model, data).scores if (row["model"], row["role"]) == ("refit", "validation")]
    reached = np.mean([row["fit"] for row in rows])
    assert reached == pytest.approx(said_of(recipe), abs=4)  # a diagnosis re-estimates over windows as well


def said_of(recipe: str) -> float:
    """The validation fit (%) of the re-tuned model that the page states."""
    page = PAGES[f"docs/recipes/{recipe}.md"].read_text(encoding="utf-8")
    found: Any = re.search(r"fit goes from ([\d.]+) %|re-tuned model reaches ([\d.]+) %", page)
    return float(found[1] or found[2])
