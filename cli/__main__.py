"""``python -m cli``, in a checkout, is ``robustness``."""

from .main import main

main()
