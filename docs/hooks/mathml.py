"""Equations as MathML, which browsers draw themselves: the site needs no script for them."""

from __future__ import annotations

import html
import re
from typing import Any

from latex2mathml.converter import convert
from markdown import Markdown
from markdown.extensions import Extension
from markdown.postprocessors import Postprocessor

_EQUATION = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.S)


class MathML(Extension):
    """Draws every equation that arithmatex has found, when the page is whole."""

    def extendMarkdown(self, md: Markdown) -> None:  # noqa: N802 (Python-Markdown's name)
        """Come last."""
        md.postprocessors.register(_Drawing(md), "mathml", -1)


class _Drawing(Postprocessor):
    def run(self, text: str) -> str:
        """The page with its equations as MathML."""
        return _EQUATION.sub(_drawn, text)


def _drawn(found: re.Match[str]) -> str:
    return convert(html.unescape(found[3]), display="block" if found[2] == "[" else "inline")


def makeExtension(**options: Any) -> MathML:  # noqa: N802 (Python-Markdown's name)
    """The extension, as Python-Markdown asks for it by the module's name."""
    return MathML(**options)
