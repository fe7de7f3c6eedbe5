"""The screen by itself: what stays, what moves, and what follows a failure."""

import io

from snakemake_logger_plugin_octsim.screen import Screen


class Console(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        return True


def test_a_job_has_its_line_at_its_end_on_a_terminal_and_at_its_begin_elsewhere() -> None:
    for stream, at_begin, at_end in ((Console(), 0, 1), (io.StringIO(), 1, 1)):
        screen = Screen(False, stream)
        screen.begin(1, "spectra", "Turn the detected light into spectra")
        assert stream.getvalue().count("octsim: spectra") == at_begin
        screen.end(1)
        screen.close()
        assert stream.getvalue().count("octsim: spectra") == at_end


def test_nothing_follows_a_failure_unless_the_job_is_tried_again() -> None:
    stream = io.StringIO()
    screen = Screen(False, stream)
    screen.begin(1, "spectra", "Turn")
    screen.fail(1)
    screen.begin(2, "focus_scan", "Scan")
    screen.line("octsim: phase slope")
    assert stream.getvalue() == "octsim: spectra: Turn\n"
    screen.begin(1, "spectra", "Turn again")
    screen.line("octsim: phase slope")
    screen.close()
    assert stream.getvalue().splitlines()[1:] == [
        "octsim: spectra: Turn again", "octsim: phase slope",
    ]  # fmt: skip


def test_a_quiet_screen_shows_errors_alone() -> None:
    stream = Console()
    screen = Screen(True, stream)
    screen.begin(1, "spectra", "Turn")
    screen.end(1)
    screen.line("octsim: phase slope")
    screen.line("octsim: no", error=True)
    screen.close()
    assert stream.getvalue() == "octsim: no\n"
