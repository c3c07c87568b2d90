"""Many networks at once: one row of facts for each, gates over all of them, and tables to hand on."""

from robustness.surveying.front import Survey, survey
from robustness.surveying.row import Gate, Row

__all__ = ["Gate", "Row", "Survey", "survey"]
