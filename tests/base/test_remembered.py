"""What was found of some things is found again, and never that of others."""

from octsim.base.remembered import remembered


def test_a_function_works_once_for_the_same_things() -> None:
    asked: list[tuple[tuple[int, ...], tuple[int, ...]]] = []

    @remembered
    def found(one: tuple[int, ...], other: tuple[int, ...]) -> tuple[int, ...]:
        asked.append((one, other))
        return one + other

    low, high = (1,), (2,)
    assert [found(low, high), found(low, high), found(high, low)] == [(1, 2), (1, 2), (2, 1)]
    assert asked == [(low, high), (high, low)]


def test_what_was_found_of_things_that_are_gone_is_not_that_of_others() -> None:
    @remembered
    def found(thing: list[int]) -> int:
        return thing[0]

    # each may stand where one before stood, and has to be held so that it does not
    assert [found([number]) for number in range(10_000)] == list(range(10_000))
