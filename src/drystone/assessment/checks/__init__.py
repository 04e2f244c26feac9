"""Checks beside the verdicts: equivalent linearisation by FEMA 440 and ATC-40."""
