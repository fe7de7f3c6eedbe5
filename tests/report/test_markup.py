"""Text can't become HTML, and data can't end the element that it stands in."""

import json
from html.parser import HTMLParser

import pytest

from octsim.report.markup import Html, data_script, details, element, escaped, joined, table

BAD = "</script><script>alert(1)</script><!-- <script> & \x00 ' \""


class Read(HTMLParser):
    """Collects the elements and the text of a piece of HTML."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.names: list[str] = []
        self.attributes: dict[str, str | None] = {}
        self.text = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.names.append(tag)
        self.attributes |= dict(attrs)

    def handle_data(self, data: str) -> None:
        self.text += data


@pytest.mark.parametrize(
    "made",
    [
        element("p", BAD), element("p", title=BAD), escaped(BAD), joined(BAD),
        details(BAD, BAD), table(BAD, [BAD], [[BAD, BAD]]), element("p", f"{Html('<b>')}"),
    ],
)  # fmt: skip
def test_text_is_text_whatever_it_holds(made: Html) -> None:
    names = {"p", "details", "summary", "table", "thead", "tbody", "tr", "th", "td", "caption"}
    assert set(Read(made).names) <= {*names, "div"}


def test_text_is_read_back_as_it_was_but_for_what_can_t_be_printed() -> None:
    read = Read(element("p", BAD, title=BAD))
    assert read.text == read.attributes["title"] == BAD.replace("\x00", "")


def test_elements_in_elements_stay_elements() -> None:
    assert element("p", element("b", "x"), class_="a", data_is="b", hidden=None) == (
        '<p class="a" data-is="b"><b>x</b></p>'
    )


def test_data_is_read_back_as_it_was_and_ends_where_it_should() -> None:
    data = {"names": [BAD], "number": 0.1, "none": None}
    made = data_script("values", data)
    assert made.count("<") == 2
    read = Read(made)
    assert read.names == ["script"]
    assert json.loads(read.text) == data


def test_data_that_is_no_json_is_refused() -> None:
    with pytest.raises(ValueError, match="JSON compliant"):
        data_script("values", float("nan"))
