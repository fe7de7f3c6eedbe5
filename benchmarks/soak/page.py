"""The part of docs/reliability.md that says what a soak found."""

from collections.abc import Sequence
from dataclasses import dataclass, field


@dataclass
class Found:
    """What has been tried, and what was not as it should be."""

    seed: str
    configs: int = 0
    schemes: dict[str, int] = field(default_factory=dict)
    grids: int = 0
    scattered: int = 0
    stops: dict[str, int] = field(default_factory=dict)
    """By signal: how many hit a run."""
    longest: dict[str, float] = field(default_factory=dict)
    """By signal: the longest that a run took to end, s."""
    together: int = 0
    """Pairs of runs with one cache."""
    cleared: int = 0
    """How often a cache was cleared meanwhile."""
    full: int = 0
    """Runs whose disk was full from some moment on."""
    failed_full: int = 0
    """Those of them that failed for it."""
    compared: int = 0
    """Sets of results that were compared with those of a run that nothing happened to."""
    wrong: list[str] = field(default_factory=list)
    """A line for each that was not as it should be."""
    minutes: float = 0.0

    def lines(self) -> list[str]:
        """Return the part's lines."""
        by_scheme = ", ".join(
            f"{count} of `{name}`" for name, count in sorted(self.schemes.items())
        )
        stops = [
            f"| {name} | {count} | {self._longest(name)} |"
            for name, count in sorted(self.stops.items())
        ]
        return [
            f"The last soak, with the seed `{self.seed}`, took {self.minutes:.0f} minutes: "
            f"{self.configs} random configs ({by_scheme}; {self.grids} with a grid, "
            f"{self.scattered} with stages scattered over as many jobs as can be).",
            "",
            "| told to stop | runs | the longest until it had ended |",
            "| --- | --- | --- |",
            *stops,
            "",
            f"{self.together} pairs of runs shared a cache, which was cleared {self.cleared} times "
            f"while they ran; {self.full} runs had a full disk from a random moment on, of which "
            f"{self.failed_full} failed for it, and went on once there was room. Of "
            f"{self.compared} sets of results, compared file by file with those of a run that "
            f"nothing happened to, and of what these runs showed, {self._wrong()}.",
        ]

    def _longest(self, name: str) -> str:
        return f"{self.longest[name]:.2f} s" if name in self.longest else ""

    def _wrong(self) -> str:
        if not self.wrong:
            return "nothing was other than it should be"
        return f"{len(self.wrong)} were not as they should be: " + "; ".join(self.wrong)


def first_line(text: str) -> str:
    """Return the last line of what was shown, short enough to be listed."""
    lines: Sequence[str] = text.splitlines() or [""]
    return lines[-1][:200]
