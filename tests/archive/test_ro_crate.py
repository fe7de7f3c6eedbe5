"""The metadata of an archive, where the library that writes it is missing."""

import sys

import pytest

from octsim.archive.ro_crate import metadata
from octsim.base.errors import OctsimError
from octsim.config.models import Config


def test_a_lack_of_rocrate_is_one_line_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rocrate.rocrate", None)
    with pytest.raises(OctsimError) as caught:
        metadata(Config(), [], {}, {})
    remedy = "pip install 'octsim[archive]'"
    assert str(caught.value) == f"rocrate is not installed; run: {remedy}"
