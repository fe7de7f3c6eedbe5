"""What a status of the accuracy says, and what a user can do about it."""

from octsim.schemes.light import AccuracyStatus


def test_every_status_but_the_good_one_brings_a_remedy() -> None:
    assert [status.name for status in AccuracyStatus if not status.remedy] == ["REACHED"]
    assert all("\n" not in status.remedy for status in AccuracyStatus)
