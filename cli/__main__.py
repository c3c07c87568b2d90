"""``python -m cli``, in a checkout, is ``robustness``."""

from robustness.__main__ import main

main()
