"""Figures and pages for people. :data:`STYLE` is what all figures have in common."""

from greybox_torch.report.style import STYLE

__all__ = ["STYLE"]
