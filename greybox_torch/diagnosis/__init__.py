"""The diagnosis: what is missing from a model, where, and how sure that is. :func:`greybox_torch.diagnose` is what users call.

Its stages are packages of their own, led through by ``pipeline.py``. What is exported here are the checks of a finished verdict.
"""

from greybox_torch.diagnosis.contradictions import contradictions, worse_than_refit

__all__ = ["contradictions", "worse_than_refit"]
