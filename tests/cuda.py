"""Tests that need a graphics processor; they are passed over, and say so, where there is none."""

from __future__ import annotations

import pytest
import torch

needs_cuda = pytest.mark.skipif(not torch.cuda.is_available(), reason="no CUDA device")
