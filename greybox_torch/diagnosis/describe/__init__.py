"""Findings and evidence in the form of the verdict."""
