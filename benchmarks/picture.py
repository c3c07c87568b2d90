"""Time against n, one panel a family, both axes logarithmic."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.comparing import Comparison, Settings, geometric_mean

__all__ = ["draw"]


def draw(comparisons: Sequence[Comparison], settings: Settings, path: Path) -> None:
    """Write the picture; hollow triangles are runs that the cap ended."""
    import matplotlib as mpl

    mpl.use("agg")
    import matplotlib.pyplot as plt

    families = list(dict.fromkeys(each.instance.family for each in comparisons))
    columns = min(3, len(families))
    rows = -(-len(families) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(5 * columns, 3.6 * rows), squeeze=False, layout="constrained")
    narrowest, widest = min(each.n for each in comparisons) / 1.2, max(each.n for each in comparisons) * 1.2
    for panel in axes.flat[len(families) :]:
        panel.set_visible(False)
    for panel, family in zip(axes.flat, families, strict=False):
        members = sorted((each for each in comparisons if each.instance.family == family), key=lambda each: each.n)
        for index, method in enumerate(("ours", *settings.methods)):
            points = [point for each in members if (point := _point(each, method, settings)) is not None]
            # Where a family has several graphs on n nodes, the line goes through their geometric mean.
            sizes = sorted({n for n, _, _ in points})
            middles = [geometric_mean([y for m, y, _ in points if m == n]) for n in sizes]
            style = {"color": f"C{index}", "linewidth": 2.2 if method == "ours" else 1.0}
            panel.plot(sizes, middles, label=method, **style)
            for is_solved, marker, face in ((True, "o", f"C{index}"), (False, "^", "none")):
                chosen = [(n, y) for n, y, solved in points if solved is is_solved]
                panel.scatter(*zip(*chosen, strict=True) if chosen else ([], []), s=22, marker=marker,
                              facecolors=face, edgecolors=f"C{index}")  # fmt: skip
        panel.axhline(settings.cap, color="gray", linestyle=":", linewidth=0.8)
        panel.set(xscale="log", yscale="log", xlim=(narrowest, widest), title=family, xlabel="n", ylabel="seconds")
    handles, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), fontsize="small")
    figure.savefig(path, dpi=120)
    plt.close(figure)


def _point(comparison: Comparison, method: str, settings: Settings) -> tuple[int, float, bool] | None:
    """Return n, seconds and whether it was solved."""
    if method == "ours":
        ours = comparison.ours
        return None if ours is None else (comparison.n, ours.seconds, ours.is_exact)
    solved = comparison.methods.get(method)
    return None if solved is None else (comparison.n, solved.seconds, solved.is_solved)
