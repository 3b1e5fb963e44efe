"""Diagnoses timed from the shell: by stage, passes by purpose, this tree beside another commit."""
