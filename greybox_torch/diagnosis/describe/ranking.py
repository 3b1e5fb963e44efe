"""What the first step of a search saw, as a table."""

from __future__ import annotations

from greybox_torch.diagnosis.select.state import SearchState

MOST_ROWS = 20


def ranking(state: SearchState) -> tuple[tuple[str, str, float, float | None], ...]:
    """Rows (port, mechanism, share explained in the screen, gain after refit) of the first step, best first."""
    if not state.steps:
        return ()
    first = state.steps[0]
    best: dict[tuple[str, str], float] = {}
    for score in (score for at_length in first.screened for score in at_length):
        key = score.attachment.named
        best[key] = max(best.get(key, 0.0), score.explained)
    gains = {r.candidate.attachment.named: r.gain for r in reversed(first.ranked)}
    rows = [(port, name, share, gains.get((port, name))) for (port, name), share in best.items()]
    return tuple(sorted(rows, key=lambda row: -row[2])[:MOST_ROWS])
