"""One page about many networks, for somebody who will not open a terminal."""

from __future__ import annotations

from robustness.reporting.front import Report, report

__all__ = ["Report", "report"]
