"""HTML that is put together from elements: text is escaped, whatever it holds."""

import html
import json
from typing import Any


class Html(str):
    """Text that is HTML already."""

    __slots__ = ()


def escaped(part: object) -> Html:
    """Return something as HTML: as it is if it is that already, else as text.

    Letters that can't be printed, as control characters of a damaged attribute, are left out.
    """
    if isinstance(part, Html):
        return part
    return Html(html.escape("".join(c for c in str(part) if c.isprintable() or c == "\n")))


def joined(*parts: object) -> Html:
    """Return parts one after the other, each escaped."""
    return Html("".join(map(escaped, parts)))


def element(name: str, *parts: object, **attributes: object) -> Html:
    """Return an element with its parts inside.

    Parameters
    ----------
    name : str
        Of the element.
    *parts
        What is in it; text is escaped.
    **attributes
        Its attributes: an underscore stands for a hyphen, one at the end (``class_``) for nothing;
        None leaves an attribute out.

    Examples
    --------
    >>> element("p", "a < b", class_="note")
    '<p class="note">a &lt; b</p>'
    """
    given = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{escaped(str(value))}"'
        for key, value in attributes.items()
        if value is not None
    )
    return Html(f"<{name}{given}>{joined(*parts)}</{name}>")


def table(caption: str, heads: list[str], rows: list[list[object]]) -> Html:
    """Return a table whose rows begin with their headings; it scrolls where it is too wide."""
    head = element("tr", *(element("th", one, scope="col") for one in heads))
    body = [
        element("tr", element("th", first, scope="row"), *(element("td", one) for one in rest))
        for first, *rest in rows
    ]
    inner = element(
        "table", element("caption", caption), element("thead", head), element("tbody", *body)
    )
    # what scrolls must be reached by the keyboard too
    return element("div", inner, class_="wide", tabindex=0, role="region", aria_label=caption)


def details(summary: str, *parts: object) -> Html:
    """Return what is shown when it is asked for."""
    return element("details", element("summary", summary), *parts)


def data_script(name: str, data: Any) -> Html:
    """Return data for the page's script, of which nothing can end the element."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    for letter in "<>&":
        text = text.replace(letter, f"\\u{ord(letter):04x}")
    return Html(f'<script type="application/json" id="{escaped(name)}">{text}</script>')
