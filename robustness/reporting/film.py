"""An attack as a picture that plays: every node's value against time, drawn as lines behind a curtain."""

from __future__ import annotations

from html import escape

from robustness.reporting.section import Film

__all__ = ["film_html"]

_WIDTH, _HEIGHT = 640, 240
_LEFT, _RIGHT, _TOP, _BOTTOM = 54, 10, 14, 30

#: Colour, dashes and width of the lines of a group; told apart without colour as well.
_STYLES = {
    "S1": ("#0072b2", "", 2.0, "S1, held low"),
    "S2": ("#b36b00", "", 2.0, "S2, held high"),
    "M": ("#d55e00", "6 4", 2.0, "malicious: what it would do by itself"),
    "rest": ("#808080", "2 3", 1.4, "other nodes"),
}


def film_html(film: Film) -> str:
    """Return the film as HTML: an SVG picture, a button to play and pause, and a slider of steps."""
    steps = max(len(line["values"]) for line in film.lines) - 1
    values = [value for line in film.lines for value in line["values"]]
    low, high = min(values), max(values)
    wide, tall = _WIDTH - _LEFT - _RIGHT, _HEIGHT - _TOP - _BOTTOM
    across = wide / max(steps, 1)
    up = tall / ((high - low) or 1.0)

    def point(k: int, value: float) -> str:
        return f"{_LEFT + k * across:.1f},{_TOP + (high - value) * up:.1f}"

    curves = "".join(
        f"<polyline fill='none' stroke='{_STYLES[line['group']][0]}' stroke-dasharray='{_STYLES[line['group']][1]}' "
        f"stroke-width='{_STYLES[line['group']][2]}' points='"
        + " ".join(point(k, value) for k, value in enumerate(line["values"]))
        + f"'><title>{escape(line['name'])}</title></polyline>"
        for line in film.lines
    )
    scale = "".join(
        f"<text x='{_LEFT - 6}' y='{_TOP + (high - value) * up + 4:.1f}' text-anchor='end' font-size='12'>"
        f"{value:g}</text>"
        for value in sorted({low, high})
    )
    present = [name for name in _STYLES if any(line["group"] == name for line in film.lines)]
    key = " ".join(
        f"<span><svg aria-hidden='true' width='28' height='8' style='display:inline;width:28px'><line x1='0' y1='4' "
        f"x2='28' y2='4' stroke='{_STYLES[name][0]}' stroke-dasharray='{_STYLES[name][1]}' stroke-width='2'/></svg> "
        f"{_STYLES[name][3]}</span>"
        for name in present
    )
    return (
        f"<div class='film' data-width='{wide}'>"
        f"<svg viewBox='0 0 {_WIDTH} {_HEIGHT}' role='img' aria-label='{escape(film.claim, quote=True)}'>"
        f"<defs><clipPath id='{{clip}}'><rect class='shown' x='{_LEFT}' y='0' width='{wide}' height='{_HEIGHT}'/>"
        f"</clipPath></defs><line x1='{_LEFT}' x2='{_LEFT}' y1='{_TOP}' y2='{_TOP + tall}' stroke='#808080'/>"
        f"<line x1='{_LEFT}' x2='{_WIDTH - _RIGHT}' y1='{_TOP + tall}' y2='{_TOP + tall}' stroke='#808080'/>"
        f"{scale}<text x='{_LEFT + wide / 2}' y='{_HEIGHT - 8}' text-anchor='middle' font-size='12'>step 0 to {steps}"
        f"</text><g clip-path='url(#{{clip}})'>{curves}</g></svg>"
        f"<div class='controls'><button type='button'>Play</button>"
        f"<input type='range' min='0' max='{steps}' value='{steps}' aria-label='step of the attack'>"
        f"<output class='step'>step {steps}</output></div><p class='faint'>{key}</p></div>"
    )
