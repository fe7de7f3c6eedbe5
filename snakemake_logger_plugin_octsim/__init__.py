"""What snakemake says of a run of octsim's: octsim's own lines in the place of its words.

A plugin as snakemake looks for them. It imports nothing of octsim's.
"""

import os
import sys
from logging import ERROR, LogRecord
from typing import Any

from snakemake.logging import ColorizingTextHandler, DefaultFilter, DefaultFormatter
from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from snakemake_logger_plugin_octsim.screen import RESULT, WORDS, Screen


def _is_of_job(record: LogRecord) -> bool:
    """Return whether an error says that a job has failed, which has said why itself."""
    return getattr(record, "exception", "") == "RuleException"


def _without_traceback(text: str) -> str:
    """Return what a failure of snakemake's own comes to, as of a disk that is full: a line."""
    if "Traceback (most recent call last)" not in text:
        return text
    return f"octsim: snakemake failed: {text.splitlines()[-1]}; --verbose shows where"


class LogHandler(LogHandlerBase):
    """Shows octsim's lines; of a dry run, and where it is asked for, snakemake's words."""

    def __post_init__(self) -> None:
        """Look at what is asked for."""
        asked, given = self.common_settings, os.environ.get(WORDS, "")
        in_full = asked.dryrun or asked.verbose or asked.printshellcmds or asked.debug_dag
        self._theirs = self._own_handler() if in_full or given == "verbose" else None
        quiet = given == "quiet" or bool(asked.quiet)
        self._screen = None if self._theirs else Screen(quiet)

    def _own_handler(self) -> Any:
        """Return snakemake's own, as it is without a plugin."""
        asked = self.common_settings
        return ColorizingTextHandler(
            nocolor=asked.nocolor,
            stream=sys.stdout if asked.stdout else sys.stderr,
            formatter=DefaultFormatter(asked.quiet, asked.show_failed_logs),
            filter=DefaultFilter(
                asked.quiet, asked.debug_dag, asked.verbose, asked.dryrun, asked.printshellcmds
            ),
        )

    def emit(self, record: LogRecord) -> None:
        """Show what a record tells a person."""
        text = str(record.msg or "")
        if self._screen is None or self._theirs is not None:
            if text.startswith("octsim: "):
                print(text, file=sys.stderr, flush=True)
            elif self._theirs is not None:
                self._theirs.handle(record)
            return
        self._show(getattr(record, "event", None), record, text)

    def _show(self, event: LogEvent | None, record: Any, text: str) -> None:
        assert self._screen is not None
        if text.startswith("octsim: "):
            self._screen.line(text)
        elif event == LogEvent.JOB_INFO:
            self._begin(record)
        elif event == LogEvent.JOB_FINISHED:
            self._screen.end(record.job_id)
        elif event == LogEvent.JOB_ERROR:
            if not os.environ.get("OCTSIM_JOB_SERVER"):  # on a cluster
                files = ", ".join(record.log)
                self._screen.line(f"octsim: {record.rule_name} failed; see {files}", error=True)
            self._screen.fail(record.jobid)
        elif text.startswith("Nothing to be done"):
            self._screen.line("octsim: nothing to be done: all is there, and of this config")
            for line in RESULT[-1]() if RESULT else ():
                self._screen.line(line)
        elif record.levelno >= ERROR and not (self._screen.failed or _is_of_job(record)):
            self._screen.line(_without_traceback(text), error=True)

    def _begin(self, record: Any) -> None:
        """Show that a job begins; shares of a stage have no lines, as what gathers them has one."""
        name, share = record.rule_name, record.rule_name == "share"
        if share:
            name = "{stage}-{number}-of-{of}".format(**record.wildcards)
        if self._screen and record.rule_msg:
            self._screen.begin(record.jobid, name, record.rule_msg, stays=not share)

    def close(self) -> None:
        """End it."""
        if self._screen:
            self._screen.close()
        super().close()

    @property
    def writes_to_stream(self) -> bool:
        """It stands in the place of snakemake's own."""
        return True

    @property
    def writes_to_file(self) -> bool:
        """Snakemake's log is written too."""
        return False

    @property
    def has_filter(self) -> bool:
        """It chooses itself."""
        return True

    @property
    def has_formatter(self) -> bool:
        """It has words of its own."""
        return True

    @property
    def needs_rulegraph(self) -> bool:
        """It draws none."""
        return False
