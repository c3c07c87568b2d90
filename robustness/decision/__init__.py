"""Decide (r,s)-robustness: the front, the ladder of techniques, their bounds, algorithms and evidence."""
