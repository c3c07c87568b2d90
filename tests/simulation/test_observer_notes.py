"""What a run tells on the way costs the same at every step."""

from __future__ import annotations

import networkx as nx

import robustness as rb


def test_every_step_tells_itself_and_the_spread_before_it() -> None:
    notes: list[str] = []
    rb.simulate(nx.complete_graph(4), "w-msr", f=0, steps=3, seed=1, progress=lambda told: notes.append(told.note))
    assert notes[0] == "step 0 of 3"
    assert [note.split(" (")[0] for note in notes] == [f"step {k} of 3" for k in range(len(notes))]
    assert all("spread" in note and "at first" in note for note in notes[1:])
