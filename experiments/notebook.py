"""Execute the evaluation notebook, as `make notebook` does.

    python -m experiments.notebook [--out DIR]

writes it with its outputs to DIR/evaluation.ipynb (`results/notebook`), and each of its figures as a picture beside it.
"""

from __future__ import annotations

import argparse
import base64
from pathlib import Path

import nbformat
from nbclient import NotebookClient

CHECKOUT = Path(__file__).parents[1]
NOTEBOOK = CHECKOUT / "experiments" / "evaluation.ipynb"


def executed(checkout: Path = CHECKOUT, timeout: float = 240.0) -> nbformat.NotebookNode:
    """The notebook with its outputs, run in the folder ``checkout``. Raises CellExecutionError where a cell does."""
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    place = {"metadata": {"path": str(checkout)}}
    NotebookClient(notebook, timeout=timeout, kernel_name="python3", resources=place).execute()
    return notebook


def pictures(notebook: nbformat.NotebookNode) -> list[bytes]:
    """All figures of an executed notebook, as PNG, in order."""
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    return [base64.b64decode(o["data"]["image/png"]) for o in outputs if "image/png" in o.get("data", {})]


def main(arguments: list[str] | None = None) -> int:
    from greybox_torch.files import write_all

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("results/notebook"), metavar="DIR")
    folder = parser.parse_args(arguments).out
    notebook = executed()
    figures = pictures(notebook)
    files: dict[Path, str | bytes] = {folder / NOTEBOOK.name: nbformat.writes(notebook)}
    write_all(files | {folder / f"figure_{k:02d}.png": picture for k, picture in enumerate(figures, start=1)})
    print(f"{folder / NOTEBOOK.name}, {len(figures)} figures")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
