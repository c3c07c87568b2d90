"""``python -m robustness.paper.audit docs`` writes docs/paper-audit.md and its drawings."""

from __future__ import annotations

import argparse
from pathlib import Path

from robustness.paper.audit.page import write

__all__ = ["main"]


def main(arguments: list[str] | None = None) -> None:
    """Write the page into the folder named on the command line."""
    parser = argparse.ArgumentParser(prog="python -m robustness.paper.audit", description="Audit the source paper.")
    parser.add_argument("folder", type=Path, help="the documentation's folder")
    write(parser.parse_args(arguments).folder)


if __name__ == "__main__":
    main()
