"""What is said of an error of pydantic's, in the config's words."""

from pydantic_core import ErrorDetails


def message_of(error: ErrorDetails) -> str:
    """Return what is said of an error, without where it is."""
    if error["type"] in {"too_short", "too_long"}:
        least = error["type"] == "too_short"
        count = error["ctx"]["min_length" if least else "max_length"]
        what = f"{count} or more" if least else f"{count} at most"
        return f"it should have {what}, not {error['ctx']['actual_length']}"
    message = error["msg"].removeprefix("Value error, ").replace("Input should", "it should")
    return message.replace("Value should", "it should")
