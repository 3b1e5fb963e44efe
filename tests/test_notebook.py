"""The evaluation notebook, executed."""

from __future__ import annotations

from pathlib import Path

import nbformat
import pytest

from experiments.notebook import CHECKOUT, NOTEBOOK, executed, pictures

RECORDINGS = CHECKOUT.parent / "shared" / "recordings" / "robot_arm"


def texts(notebook: nbformat.NotebookNode) -> str:
    """All that an executed notebook prints, tables among it."""
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    return "\n".join(output.get("text", "") or output.get("data", {}).get("text/markdown", "") for output in outputs)


def row(text: str, *beginning: str) -> list[str]:
    """The cells of the first line of a table that begins so."""
    start = f"| {' | '.join(beginning)} |"
    return [
        cell.strip()
        for cell in next(line for line in text.splitlines() if line.startswith(start)).strip("| ").split("|")
    ]


def test_it_is_kept_without_outputs() -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert len(code) >= 8
    assert not any(cell.outputs or cell.execution_count for cell in code)


def test_without_the_real_recordings(tmp_path: Path) -> None:
    checkout = tmp_path / "checkout"
    checkout.mkdir()
    for name in ("checkpoints", "experiments", "greybox_torch"):
        (checkout / name).symlink_to(CHECKOUT / name)
    notebook = executed(checkout)
    text, figures = texts(notebook), pictures(notebook)
    assert "The recordings of the real arm are not there" in text
    assert "as the checkpoints' cards tell" in text
    assert "UserError: checkpoint …/cut.safetensors: damaged" in text
    start, physics, named, hybrid = (float(cell.split()[0]) for cell in row(text, "Around rest", "validation")[2:])
    assert named > 97.0 > 60.0 > physics > start
    assert named > hybrid > 95.0
    curves = text.partition("| model of the demo |")[2]
    wrong = {name: float(row(curves, name)[1].removesuffix(" %")) for name in ("physics", "named", "hybrid")}
    assert wrong["named"] < 1.0 < 10.0 < wrong["physics"]
    assert wrong["hybrid"] < 2.0
    assert len(figures) == 6
    assert all(picture.startswith(b"\x89PNG") and len(picture) > 10_000 for picture in figures)


@pytest.mark.skipif(not RECORDINGS.is_dir(), reason="the real recordings are not in ../shared beside the checkout")
def test_with_the_real_recordings() -> None:
    notebook = executed()
    text = texts(notebook)
    assert "are not there" not in text.replace("No ablation", "")
    start, physics, named, _ = (float(cell.split()[0]) for cell in row(text, "Validation 1", "validation")[2:])
    assert start < 80.0 < 88.0 < physics < named
    assert len(pictures(notebook)) == 10
