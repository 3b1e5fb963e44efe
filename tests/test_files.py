from __future__ import annotations

import json
from pathlib import Path

import pytest

from greybox_torch.errors import UserError
from greybox_torch.files import json_text, replacing, write_text


def test_writes_into_a_folder_that_is_not_there_yet(tmp_path: Path) -> None:
    write_text(tmp_path / "a" / "b" / "c.txt", "φ")
    assert (tmp_path / "a" / "b" / "c.txt").read_text(encoding="utf-8") == "φ"
    assert [p.name for p in (tmp_path / "a" / "b").iterdir()] == ["c.txt"]


def test_an_error_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "report.html"
    write_text(path, "old")
    with pytest.raises(ZeroDivisionError), replacing(path) as temporary:
        assert temporary.suffix == ".html"
        temporary.write_text("half of the n")
        raise ZeroDivisionError
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_place_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(UserError, match=r"file/a.txt: cannot be written"):
        write_text(tmp_path / "file" / "a.txt", "")
    (tmp_path / "folder").mkdir()
    with pytest.raises(UserError, match=r"folder: cannot be written"):
        write_text(tmp_path / "folder", "")
    for name in ("a\0b", "x" * 300):
        with pytest.raises(UserError, match="cannot be written"):
            write_text(tmp_path / name, "")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["file", "folder"]


def test_json_has_null_for_what_json_cannot_say() -> None:
    result = {"a": float("nan"), "b": [1.5, float("inf")], "c": (None, True, "φ")}
    assert json.loads(json_text(result)) == {"a": None, "b": [1.5, None], "c": [None, True, "φ"]}
