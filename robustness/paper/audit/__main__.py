"""``python -m robustness.paper.audit docs`` writes docs/paper-audit.md and its drawings."""

from __future__ import annotations

import argparse
from contextlib import nullcontext
from pathlib import Path

from robustness.cubes import opened_cluster
from robustness.paper.audit.page import write

__all__ = ["main"]


def main(arguments: list[str] | None = None) -> None:
    """Write the page into the folder named on the command line."""
    parser = argparse.ArgumentParser(prog="python -m robustness.paper.audit", description="Audit the source paper.")
    parser.add_argument("folder", type=Path, help="the documentation's folder")
    parser.add_argument("--cluster", metavar="ADDRESS", help="count on a Dask cluster: tcp://HOST:PORT or local:N")
    asked = parser.parse_args(arguments)
    with nullcontext() if asked.cluster is None else opened_cluster(asked.cluster) as executor:
        write(asked.folder, executor)


if __name__ == "__main__":
    main()
