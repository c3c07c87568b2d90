"""``python -m cli`` is ``robustness``."""

from cli.main import main

main()
