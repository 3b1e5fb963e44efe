"""What was done to the samples of recordings, each sentence once."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.data import Recording
from greybox_torch.name_lists import brief

_FILE = "\0"
"""Stands for the one file that a note speaks of."""


def told_once(recordings: Sequence[Recording]) -> list[str]:
    """The notes of all recordings as sentences, in which those that differ in the name of the file alone are one."""
    names: dict[str, list[str]] = {}
    files: dict[str, list[str]] = {}
    for recording in recordings:
        for note in recording.notes:
            alike, file = _without_file(note, recording)
            names.setdefault(alike, []).append(recording.name)
            files.setdefault(alike, []).extend(file)
    return [
        f"{brief(list(dict.fromkeys(own)))}: {note.replace(_FILE, brief(list(dict.fromkeys(files[note]))))}."
        for note, own in names.items()
    ]


def _without_file(note: str, recording: Recording) -> tuple[str, list[str]]:
    """A note with a mark in the place of the file that it names, and that; as it is where it names none of them, or several."""
    own = {file.name for file in (recording.source, *recording.further) if file is not None}
    named = [name for name in own if f" {name}," in note]
    return (note.replace(f" {named[0]},", f" {_FILE},"), named) if len(named) == 1 else (note, [])
