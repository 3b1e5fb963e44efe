"""An error beside the noise is told so that it can be read once."""

from __future__ import annotations

from greybox_torch.diagnosis.describe.beside_noise import told_beside_noise


def test_what_is_noise_and_what_is_motion_is_told_apart() -> None:
    """Seen: "0.21 times the noise that the recordings' high-frequency floor shows, an upper bound, as part of that is motion"."""
    start = "Over short windows (of the lengths tried, the one with the largest error), the error is 0.21 times "
    assert told_beside_noise(0.21, more=False, known=False) == (
        f"{start}what the recordings show at their highest frequencies. Part of that is motion: the noise is smaller, and how much "
        "smaller is not known."
    )
    noise = "the noise (read from the recordings' highest frequencies)"
    assert told_beside_noise(0.21, more=False, known=True) == f"{start}{noise}."
    for known in (True, False):
        assert told_beside_noise(1.7, more=True, known=known).endswith(f"1.7 times {noise}: more than noise is left.")
