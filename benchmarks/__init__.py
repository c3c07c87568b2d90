"""How fast and how exact: every algorithm of the registry side by side; see ``benchmarks/README.md``."""
