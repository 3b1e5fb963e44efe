from __future__ import annotations

from pathlib import Path

import pytest

from greybox_torch.commands.options import Options


@pytest.mark.parametrize(
    ("card", "folder"),
    [("bench/dataset.toml", "bench"), ("bench/rich.toml", "bench-rich"), ("bench/plain.toml", "bench-plain")],
)
def test_cards_in_one_folder_do_not_share_results(tmp_path: Path, card: str, folder: str) -> None:
    assert Options().folder(tmp_path / card) == Path("results") / folder


def test_out_wins(tmp_path: Path) -> None:
    assert Options(out=tmp_path).folder(Path("any.toml")) == tmp_path
