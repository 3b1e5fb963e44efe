"""The record of a proof: one line an event, each with the hash of the line before. What was said after the seal was opened does not count.

Events: `sealed` (seed, set, commitment, hashes of the cases, of the rules and of the tool), `verdict` (a case and the hash of what the
tool said of it, or why it said nothing), `opened`. Nothing but scoring may follow `opened`.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from experiments.concealed.proof.errors import ProofError
from experiments.concealed.proof.files import canonical, sha256

Entry = dict[str, Any]
BEGINNING = "0" * 64


class Record:
    """The record in a file, read and checked when it is made."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.entries: list[Entry] = []
        self._last = BEGINNING
        if file.exists():
            self._read()

    @property
    def sealed(self) -> Entry | None:
        return next((e for e in self.entries if e["event"] == "sealed"), None)

    @property
    def opened(self) -> Entry | None:
        return next((e for e in self.entries if e["event"] == "opened"), None)

    @property
    def verdicts(self) -> dict[str, Entry]:
        """By the name of the case."""
        return {e["case"]: e for e in self.entries if e["event"] == "verdict"}

    def add(self, event: str, **fields: Any) -> Entry:
        """Append an event and flush it to the disk. Raises ProofError for one that the protocol does not allow now."""
        self._allow(event, fields)
        entry = {
            "event": event,
            "time": datetime.now(UTC).isoformat(timespec="seconds"),
            "before": self._last,
            **fields,
        }
        line = canonical(entry)
        self.file.parent.mkdir(parents=True, exist_ok=True)
        with self.file.open("ab") as file:
            file.write(line + b"\n")
            file.flush()
            os.fsync(file.fileno())
        self.entries.append(entry)
        self._last = sha256(line)
        return entry

    def _allow(self, event: str, fields: Mapping[str, Any]) -> None:
        if self.opened is not None:
            raise ProofError(
                f"{self.file}: the seal was opened at {self.opened['time']}; a {event} after that is refused. "
                "A new proof needs a new folder"
            )
        if event != "sealed" and self.sealed is None:
            raise ProofError(f"{self.file}: nothing is sealed yet; expected the sealing before a {event}")
        if event == "sealed" and self.sealed is not None:
            raise ProofError(
                f"{self.file}: the answers were sealed at {self.sealed['time']}; they cannot be sealed again"
            )
        if event == "verdict" and fields["case"] in self.verdicts:
            raise ProofError(f"{self.file}: the verdict on {fields['case']} is frozen; another is refused")
        if event == "verdict" and self.sealed is not None and fields["case"] not in self.sealed["cases"]:
            raise ProofError(f"{self.file}: {fields['case']} is not among the sealed cases")

    def _read(self) -> None:
        content = self.file.read_bytes()
        whole, _, torn = content.rpartition(b"\n")
        for number, line in enumerate(whole.split(b"\n") if whole else [], start=1):
            try:
                entry = json.loads(line)
                intact = entry["before"] == self._last
            except (json.JSONDecodeError, KeyError, TypeError):
                intact = False
                entry = {}
            if not intact:
                raise ProofError(
                    f"{self.file}: line {number} does not follow from the line before: the record was changed"
                )
            self.entries.append(entry)
            self._last = sha256(line)
        if torn:  # killed while writing: the event did not happen
            with self.file.open("r+b") as file:
                file.truncate(len(whole) + 1 if whole else 0)
