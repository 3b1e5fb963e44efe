"""Sealing, freezing, opening: what the protocol refuses, and that it goes on where it was left."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from experiments.concealed.proof import protocol
from experiments.concealed.proof.errors import ProofError
from experiments.concealed.proof.files import canonical, sha256
from experiments.concealed.proof.protocol import Proof
from experiments.concealed.proof.record import Record
from experiments.concealed.proof.seal import SEALED, UNSEALING, seal, unseal
from experiments.verdicts import running
from experiments.verdicts.running import Outcome
from tests.concealed.proof.by_hand import ANSWERS, VERDICTS


def quiet(text: str) -> None:
    """No progress."""


def sealed_and_frozen(folder: Path) -> Proof:
    proof = Proof(folder, quiet)
    proof.prepare("quick", 7)
    proof.diagnose(workers=2, time_limit=10)
    return proof


def test_a_seal_opens_to_what_was_sealed_and_to_nothing_else(tmp_path: Path):
    commitment = seal(tmp_path, ANSWERS)
    assert unseal(tmp_path, commitment) == json.loads(canonical(ANSWERS))
    assert b"backlash" not in (tmp_path / SEALED).read_bytes()
    assert (tmp_path / UNSEALING).stat().st_mode & 0o077 == 0
    assert seal(tmp_path / "again", ANSWERS) != commitment  # salted: equal answers do not show
    with pytest.raises(ProofError, match="not those that were sealed"):
        unseal(tmp_path / "again", commitment)
    content = bytearray((tmp_path / SEALED).read_bytes())
    content[40] ^= 1
    (tmp_path / SEALED).write_bytes(content)
    with pytest.raises(ProofError, match="changed since it was sealed"):
        unseal(tmp_path, commitment)
    (tmp_path / UNSEALING).unlink()
    with pytest.raises(ProofError, match="not there"):
        unseal(tmp_path, commitment)


def test_the_commitment_is_printed_before_the_tool_is_asked(tmp_path: Path, by_hand):
    printed: list[tuple[str, int]] = []
    proof = Proof(tmp_path, lambda text: printed.append((text, len(by_hand()))))
    proof.prepare("quick", 7)
    proof.diagnose(workers=1, time_limit=10)
    assert proof.record.sealed is not None
    commitment = proof.record.sealed["commitment"]
    assert [asked for text, asked in printed if commitment in text] == [0]
    assert by_hand() == sorted(ANSWERS)


def test_answers_are_nowhere_in_the_clear_before_opening(tmp_path: Path, by_hand):
    proof = sealed_and_frozen(tmp_path)
    before = [f for f in tmp_path.rglob("*") if f.is_file() and "verdicts" not in f.parts]
    assert not [f for f in before if b"backlash" in f.read_bytes()]
    assert proof.open() == json.loads(canonical(ANSWERS))
    assert json.loads((tmp_path / "cases" / "c002" / "key.json").read_text())["effects"] == ["backlash"]


def test_a_verdict_changed_after_opening_is_refused(tmp_path: Path, by_hand):
    proof = sealed_and_frozen(tmp_path)
    proof.open()
    better = {**VERDICTS["c004"], "mismatch": True}
    (tmp_path / "verdicts" / "c004" / "verdict.json").write_text(json.dumps(better))
    with pytest.raises(ProofError, match=r"c004.*produced or changed later is refused"):
        Proof(tmp_path, quiet).open()


def test_a_verdict_produced_after_opening_is_refused(tmp_path: Path, by_hand, monkeypatch: pytest.MonkeyPatch):
    failed = Outcome(1.0, "no verdict after 1 s", "no verdict after 1 s")
    monkeypatch.setattr(running, "diagnose", lambda card, out, limit, *, threads: failed)
    proof = sealed_and_frozen(tmp_path)
    proof.open()
    late = tmp_path / "verdicts" / "c001" / "verdict.json"
    late.parent.mkdir(parents=True)
    late.write_text(json.dumps(VERDICTS["c001"]))
    with pytest.raises(ProofError, match=r"frozen at .* was no verdict"):
        Proof(tmp_path, quiet).open()
    with pytest.raises(ProofError, match="a verdict after that is refused"):
        Record(tmp_path / "record.jsonl").add("verdict", case="c001", sha256="0", said="", seconds=0.0)


def test_after_opening_the_tool_is_not_asked_again(tmp_path: Path, by_hand):
    sealed_and_frozen(tmp_path).open()
    again = Proof(tmp_path, quiet)
    again.prepare("quick", None)
    again.diagnose(workers=2, time_limit=10)
    assert again.open() == json.loads(canonical(ANSWERS))
    assert by_hand() == sorted(ANSWERS)


def test_opening_waits_for_every_verdict(tmp_path: Path, by_hand):
    proof = Proof(tmp_path, quiet)
    with pytest.raises(ProofError, match="nothing is sealed yet"):
        proof.open()
    proof.prepare("quick", 7)
    with pytest.raises(ProofError, match="no verdict yet on 6 cases"):
        proof.open()
    assert proof.record.opened is None


def test_changed_cases_and_changed_rules_are_refused(tmp_path: Path, by_hand, monkeypatch: pytest.MonkeyPatch):
    proof = sealed_and_frozen(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(protocol, "rules_hash", lambda: "other")
        with pytest.raises(ProofError, match="rules of scoring have changed"):
            proof.open()
    (tmp_path / "cases" / "c003" / "dataset.toml").write_text("other")
    with pytest.raises(ProofError, match="c003: changed since it was sealed"):
        proof.open()


def test_another_version_of_the_tool_is_refused_until_the_seal_is_open(
    tmp_path: Path, by_hand, monkeypatch: pytest.MonkeyPatch
):
    proof = Proof(tmp_path, quiet)
    proof.prepare("quick", 7)
    other = {"commit": "", "sources": "0"}
    with monkeypatch.context() as patch:
        patch.setattr(protocol, "tool_version", lambda: other)
        with pytest.raises(ProofError, match="expected the tool that was sealed"):
            proof.diagnose(workers=1, time_limit=10)
    proof.diagnose(workers=1, time_limit=10)
    with monkeypatch.context() as patch:
        patch.setattr(protocol, "tool_version", lambda: other)
        with pytest.raises(ProofError, match="expected the tool that was sealed"):
            proof.open()
    proof.open()
    monkeypatch.setattr(protocol, "tool_version", lambda: other)
    assert Proof(tmp_path, quiet).open()  # scored again, years later


def test_an_interrupted_proof_goes_on_where_it_was(tmp_path: Path, by_hand, monkeypatch: pytest.MonkeyPatch):
    asked = running.diagnose
    left = 3

    def killed(card: Path, out: Path, limit: float, *, threads: int) -> Outcome:
        nonlocal left
        left -= 1
        outcome = asked(card, out, limit, threads=threads)
        if left < 0:
            raise KeyboardInterrupt  # the verdict is written, and not yet on the record
        return outcome

    proof = Proof(tmp_path, quiet)
    proof.prepare("quick", 7)
    monkeypatch.setattr(running, "diagnose", killed)
    with pytest.raises(KeyboardInterrupt):
        proof.diagnose(workers=1, time_limit=10)
    monkeypatch.setattr(running, "diagnose", asked)
    with (tmp_path / "record.jsonl").open("ab") as file:
        file.write(b'{"event": "verd')  # torn by the kill
    again = Proof(tmp_path, quiet)
    frozen = dict(again.record.verdicts)
    assert len(frozen) == 3
    again.prepare("quick", None)
    again.diagnose(workers=1, time_limit=10)
    assert set(again.record.verdicts) == set(ANSWERS)
    assert {name: again.record.verdicts[name] for name in frozen} == frozen
    assert again.open()


def test_a_drawing_that_was_killed_begins_anew_with_its_seed(tmp_path: Path, by_hand, monkeypatch: pytest.MonkeyPatch):
    with monkeypatch.context() as patch:
        patch.setattr(protocol, "seal", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            Proof(tmp_path, quiet).prepare("quick", None)
    seed = json.loads((tmp_path / "seed.json").read_text())["seed"]
    proof = Proof(tmp_path, quiet)
    proof.prepare("quick", None)
    assert proof.record.sealed is not None
    assert proof.record.sealed["seed"] == seed


def test_what_a_killed_run_goes_on_writing_is_not_taken_for_a_case(
    tmp_path: Path, by_hand, monkeypatch: pytest.MonkeyPatch
):
    """Seen: two draws wrote into one folder, and 27 of 43 stages had recordings of other machines."""
    draw, killed = protocol.draw_cases, tmp_path / "cases.partial-1"

    def beside_another(planned: object, seed: int, folder: Path, **how: object) -> object:
        for name in ANSWERS:
            (killed / name).mkdir(parents=True)
            (killed / name / "dataset.toml").write_text('name = "another seed"\n')
        return draw(planned, seed, folder, **how)  # type: ignore[arg-type]

    monkeypatch.setattr(protocol, "draw_cases", beside_another)
    Proof(tmp_path, quiet).prepare("quick", 7)
    cards = [card.read_text() for card in (tmp_path / "cases").glob("*/dataset.toml")]
    assert len(cards) == len(ANSWERS) and all(card.endswith(' 7"\n') for card in cards)


def test_a_folder_keeps_its_proof(tmp_path: Path, by_hand):
    sealed_and_frozen(tmp_path)
    with pytest.raises(ProofError, match="holds a proof of the quick set with seed 7"):
        Proof(tmp_path, quiet).prepare("quick", 8)
    with pytest.raises(ProofError, match="asked for was standard"):
        Proof(tmp_path, quiet).prepare("standard", None)


def test_record_allows_nothing_out_of_order_and_notices_changes(tmp_path: Path):
    record = Record(tmp_path / "record.jsonl")
    with pytest.raises(ProofError, match="nothing is sealed yet"):
        record.add("opened")
    record.add("sealed", cases={"a": "1"})
    with pytest.raises(ProofError, match="cannot be sealed again"):
        record.add("sealed", cases={})
    with pytest.raises(ProofError, match="b is not among the sealed cases"):
        record.add("verdict", case="b", sha256="0")
    record.add("verdict", case="a", sha256=sha256(b"1"))
    with pytest.raises(ProofError, match="the verdict on a is frozen"):
        record.add("verdict", case="a", sha256=sha256(b"2"))
    record.add("opened")
    with pytest.raises(ProofError, match="was opened at"):
        record.add("opened")
    text = record.file.read_text().replace(sha256(b"1"), sha256(b"2"))
    record.file.write_text(text)
    with pytest.raises(ProofError, match="line 3 does not follow"):
        Record(record.file)
