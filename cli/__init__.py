"""The command line ``robustness``: a thin shell over :mod:`robustness`, one file per command.

Results go to standard output, everything else to standard error, and the exit code (``exit_codes``) says what was
proven. Modules import each other relatively: installed, this folder is ``robustness.cli`` (docs/adr/0005).
"""
