"""Equations as MathML, made when the pages are: browsers show it as it is, and nothing is loaded from elsewhere."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from docutils.nodes import Node
from latex2mathml.converter import convert as mathml_of
from sphinx.application import Sphinx

FUNCTIONS = "arctan|cos|cosh|exp|ln|log|sgn|sin|tan|tanh"
THIN = '<mspace width="0.167em"/>'


def convert(latex: str, display: str = "inline") -> str:
    """An equation as MathML, with the thin space between a function and its argument that the library leaves out."""
    named = rf"(<mi>(?:{FUNCTIONS})</mi>)(?!<mo stretchy=\"false\">&#x00028;)"
    return re.sub(named, rf"<mrow>{THIN}\1{THIN}</mrow>", mathml_of(latex, display=display))


def inline(translator: Any, node: Node) -> None:
    """An equation within a line."""
    translator.body.append(convert(node.astext()))
    raise nodes.SkipNode


def display(translator: Any, node: Any) -> None:
    """An equation on lines of its own, with its number if it has a label."""
    translator.body.append(translator.starttag(node, "div", CLASS="math"))
    if node["number"]:
        translator.body.append(f'<span class="eqno">({node["number"]})')
        translator.add_permalink_ref(node, "Link to this equation")
        translator.body.append("</span>")
    translator.body.append(convert(node.astext(), display="block"))
    translator.body.append("</div>")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (inline, None), (display, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
