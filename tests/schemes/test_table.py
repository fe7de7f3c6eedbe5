"""What a preset stands for is what the docs measure."""

import re

from checkout import ROOT

from octsim.schemes.table import SCHEMES

SETTING = re.compile(r"^\| (\w+) \| `tracing\.accuracy(?:, (\w+))? ([0-9.e-]+)` \|", re.MULTILINE)


def test_presets_are_those_whose_errors_the_docs_state() -> None:
    stated = {
        name: (scheme or "paths", float(accuracy))
        for name, scheme, accuracy in SETTING.findall((ROOT / "docs" / "tradeoff.md").read_text())
    }
    assert stated == {
        name: (row.name, options["accuracy"])
        for row in SCHEMES.values()
        for name, options in row.presets.items()
    }
