"""``python -m robustness``, and the entry point of the command: finds the command line under a name that is ours alone.

The modules of the command line are ``robustness.cli``. Installed, they are a subpackage like any other. In a checkout
their folder ``cli`` stands beside this package and is found by its place, never by the general name ``cli``, which a
folder or a distribution of somebody else may bear as well (docs/adr/0005).
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
from pathlib import Path

__all__ = ["main"]

_NAME = "robustness.cli"


def main() -> None:
    """Run the command line."""
    here = Path(__file__).resolve().parent
    try:
        if not (here / "cli").is_dir():
            _load_from(here.parent / "cli")
        importlib.import_module(f"{_NAME}.main").main()
    except KeyboardInterrupt:  # while it is imported; later the command line says this, and what is known
        sys.stderr.write("interrupted: nothing is claimed\n")
        sys.exit(130)


def _load_from(folder: Path) -> None:
    """Import the package in ``folder`` under the name that it has where it is installed."""
    spec = importlib.util.spec_from_file_location(
        _NAME, folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    if spec is None or spec.loader is None:
        raise ModuleNotFoundError(f"the command line is not at {folder}", name=_NAME)
    module = importlib.util.module_from_spec(spec)
    sys.modules[_NAME] = module
    spec.loader.exec_module(module)


if __name__ == "__main__":
    main()
