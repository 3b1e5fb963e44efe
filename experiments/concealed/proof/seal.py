"""The sealed key: all answers, encrypted, and a commitment to them that is printed before the tool says a word.

The commitment is SHA-256 over a random salt and the answers. Who holds it can check, once the seal is open, that the answers are those
that were sealed. The answers are encrypted with Fernet (AES-128-CBC with HMAC-SHA256, from the library `cryptography`), and the key to
that lies in a file apart, readable by its owner alone, until the seal is opened.
"""

from __future__ import annotations

import json
import secrets
from pathlib import Path
from typing import Any

from cryptography.fernet import Fernet, InvalidToken

from experiments.concealed.proof.errors import ProofError
from experiments.concealed.proof.files import canonical, sha256, write_bytes

SEALED, UNSEALING = "sealed_answers.bin", "unsealing.key"


def seal(folder: Path, answers: dict[str, Any]) -> str:
    """Write the sealed answers and, apart, what opens them; the commitment."""
    content = canonical({"salt": secrets.token_hex(32), "answers": answers})
    key = Fernet.generate_key()
    write_bytes(folder / UNSEALING, key, mode=0o600)
    write_bytes(folder / SEALED, Fernet(key).encrypt(content))
    return sha256(content)


def unseal(folder: Path, commitment: str) -> dict[str, Any]:
    """The answers. Raises ProofError where they are not those that were committed to."""
    for name in (UNSEALING, SEALED):
        if not (folder / name).is_file():
            raise ProofError(f"{folder / name}: not there; expected the file that the sealing wrote")
    try:
        content = Fernet((folder / UNSEALING).read_bytes()).decrypt((folder / SEALED).read_bytes())
    except (InvalidToken, ValueError) as error:
        raise ProofError(
            f"{folder / SEALED}: cannot be opened with {UNSEALING}: changed since it was sealed"
        ) from error
    if sha256(content) != commitment:
        raise ProofError(
            f"{folder / SEALED}: the answers have the hash {sha256(content)}, the commitment is {commitment}: not those that were sealed"
        )
    return json.loads(content)["answers"]
