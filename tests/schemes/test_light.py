"""What a status of the accuracy says, and what a user can do about it."""

from octsim.schemes.light import AccuracyStatus
from octsim.schemes.table import COUNTED_RAYS


def test_every_status_but_the_good_one_brings_a_remedy() -> None:
    assert [status.name for status in AccuracyStatus if not status.remedy] == ["REACHED"]
    assert all("\n" not in status.remedy for status in AccuracyStatus)
    assert f"tracing.scheme {COUNTED_RAYS.name}," in AccuracyStatus.NOT_REACHED.remedy
