"""A report as one page that needs nothing else: its figures are in it, as SVG."""

from __future__ import annotations

import io

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

from server.reports.blocks import Document, Drawing
from server.reports.style import figure, look


def html(document: Document) -> bytes:
    """The page."""
    environment = Environment(
        loader=PackageLoader("server.reports"),
        undefined=StrictUndefined,
        autoescape=select_autoescape(["j2"]),
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["svg"] = _svg
    with look():
        page = environment.get_template("document.html.j2").render(document=document)
    return page.strip().encode()


def _svg(drawing: Drawing) -> str:
    """Markup of the figure's one `<svg>`."""
    drawn, text = figure(drawing.width, drawing.height), io.StringIO()
    drawing.draw(drawn)
    drawn.savefig(text, format="svg", metadata={"Date": None, "Creator": "Becalm"})
    content = text.getvalue()
    return content[content.index("<svg") :]
