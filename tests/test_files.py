from __future__ import annotations

import json
from pathlib import Path

import pytest

from greybox_torch.errors import UserError
from greybox_torch.files import json_text, replacing, write_all, write_text


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


def test_files_that_belong_together_take_their_places_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Seen: the last one was the first to be replaced, so that a process killed then left a row that said of old results they were new."""
    places, taken, rename = [tmp_path / name for name in ("a.json", "b.json", "row.json")], [], Path.replace

    def replaced(self: Path, target: Path) -> Path:
        assert len(list(tmp_path.glob(".*partial*"))) == len(places) - len(taken)  # all are written by then
        if target.name == "row.json":
            raise OSError(28, "No space left on device")
        taken.append(target)
        return rename(self, target)

    write_all(dict.fromkeys(places, "old"))
    monkeypatch.setattr(Path, "replace", replaced)
    with pytest.raises(UserError, match=r"row\.json: cannot be written: No space left on device"):
        write_all(dict.fromkeys(places, "new"))
    assert taken == places[:2]
    assert [path.read_text() for path in places] == ["new", "new", "old"]
    assert sorted(tmp_path.iterdir()) == places


def test_json_has_null_for_what_json_cannot_say() -> None:
    result = {"a": float("nan"), "b": [1.5, float("inf")], "c": (None, True, "φ")}
    assert json.loads(json_text(result)) == {"a": None, "b": [1.5, None], "c": [None, True, "φ"]}
