"""The numbers that kernels and their callers share: rows of states, opcodes of transcripts, reasons to return."""

from __future__ import annotations

# Rows of a state of the subset search (robustness.kernels.search_rules).
C, P, F, T = 0, 2, 4, 6

# Transcript opcodes; EXCLUDE + 2 * (blockers - 1) + side, BRANCH + 2 * kind + side. See docs/certificate-format.md.
PROPAGATE, ROOT, BRANCH, EXCLUDE = 0, 1, 2, 6

# Kinds of literals of the subset search.
SATISFIED, MEMBER = 0, 1

# Columns of its table of levels.
PENDING, SYMMETRIC, GIVEN = 0, 1, 2

# Counters of both searches.
NODES, FAILED, PROBES = 0, 1, 2

# Why a search returned.
CLOSED, FOUND, PAUSED, FLUSH, GROW, DONATED, STUCK = range(7)

#: Look-ahead of the subset search tries this many nodes on one side: see docs/adr/0002.
TRIED = 8

#: That of the trap search, where probes cost as much and tell less: see docs/design-traps.md.
TRAPS_TRIED = 4

# Rows of a state of the trap search (robustness.kernels.trap_rules), its number of rows, and its kinds of literals.
TRAP_P, TRAP_Q, TRAP_F, TRAP_T, TRAP_Z, TRAP_ROWS = 0, 2, 4, 6, 8, 9
NORMAL, MALICIOUS = 0, 1
