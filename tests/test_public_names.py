from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import greybox_torch


def test_load_dataset_is_public() -> None:
    from greybox_torch.data import load_dataset

    assert greybox_torch.load_dataset is load_dataset


@pytest.mark.parametrize("name", greybox_torch.__all__)
def test_every_public_name_is_there(name: str) -> None:
    assert getattr(greybox_torch, name).__name__ == name
    assert name in dir(greybox_torch)


def test_only_public_names_are_offered() -> None:
    offered = [name for name in dir(greybox_torch) if not name.startswith("__")]
    assert offered == sorted(greybox_torch.__all__) and "__version__" in dir(greybox_torch)


def test_unknown_name() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'Motor'"):
        _ = greybox_torch.Motor  # type: ignore[attr-defined]


HEAVY = ("torch", "pandas", "matplotlib", "scipy", "h5py", "pyarrow")
SLOW_PARTS = ("pandas", "matplotlib", "scipy.stats", "scipy.optimize", "scipy.signal")


@pytest.mark.parametrize(
    ("module", "heavy"),
    [
        ("greybox_torch", HEAVY),
        ("greybox_torch.cli", HEAVY),
        ("greybox_torch.data", HEAVY),
        ("greybox_torch.commands.diagnose", SLOW_PARTS),
    ],
)
def test_import_is_light(module: str, heavy: tuple[str, ...]) -> None:
    program = f"import sys, {module}; print([name for name in {heavy} if name in sys.modules])"
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


def test_columns_that_tell_no_unit_load_no_unit_registry() -> None:
    """It is a twentieth of the time that a fit takes."""
    card = Path(greybox_torch.__file__).parent / "demo" / "dataset.toml"
    program = (
        "import sys; from pathlib import Path; from greybox_torch.drafting.contradicted import contradictions; "
        f"print(contradictions(Path({str(card)!r})), 'pint' in sys.modules)"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[] False"


def test_no_public_name_is_hidden_by_a_package() -> None:
    """A package `greybox_torch.NAME` would replace the public NAME as soon as anything imports it."""
    home = Path(greybox_torch.__file__).parent
    assert not [n for n in greybox_torch.__all__ if (home / n).is_dir() or (home / f"{n}.py").is_file()]
