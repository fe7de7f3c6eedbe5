"""Formulas of the site as MathML, which browsers draw by themselves: no script, no request."""

import re

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator

# docutils puts the index of what has a hat below it; it belongs beside it
INDEXED_HAT = re.compile(
    r"<munderover>\s*(<m[in]>[^<]*</m[in]>)\s*(<m[in]>[^<]*</m[in]>)\s*(<mo[^>]*>ˆ</mo>)"
    r"\s*</munderover>"
)
BESIDE = r'<msub><mover accent="true">\1\3</mover>\2</msub>'


def formula(tex: str, as_block: bool = False) -> str:
    """Return a formula as MathML."""
    return INDEXED_HAT.sub(BESIDE, tex2mathml(tex, as_block=as_block))


def visit_math(self: HTML5Translator, node: nodes.math) -> None:
    """Write a formula within a line."""
    self.body.append(formula(node.astext()))
    raise nodes.SkipNode


def visit_block(self: HTML5Translator, node: nodes.math_block) -> None:
    """Write a formula on a line of its own."""
    self.body.append(f'<div class="math">{formula(node.astext(), as_block=True)}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Give Sphinx one more way to write formulas."""
    app.add_html_math_renderer("mathml", (visit_math, None), (visit_block, None))
    return {"parallel_read_safe": True}
