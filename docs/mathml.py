"""Formulas as MathML, written when the documents are built: browsers show them without a script or a network."""

from __future__ import annotations

from typing import Any

from latex2mathml.converter import convert


def mathml_of(formula: str, display: str = "inline") -> str:
    """Return a formula as MathML. A set difference gets the stroke that common fonts have, as an operator."""
    return convert(formula, display=display).replace("<mi>&#x029F5;</mi>", "<mo>&#x2216;</mo>")


def _inline(writer: Any, node: Any) -> None:
    writer.body.append(mathml_of(node.astext()))
    raise _skip()


def _block(writer: Any, node: Any) -> None:
    writer.body.append(f"<div class='math'>{mathml_of(node.astext(), 'block')}</div>\n")
    raise _skip()


def _skip() -> Exception:
    from docutils.nodes import SkipNode

    return SkipNode()


def setup(app: Any) -> dict[str, bool]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", inline_renderers=(_inline, None), block_renderers=(_block, None))
    return {"parallel_read_safe": True}
