"""The next recording: an input within limits that tells hypotheses apart, or that sharpens a parameter."""
