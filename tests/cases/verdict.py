"""Counts the rows of a case. Each row prints a line, and the last line says how many of them are right."""
import re

import tvi

_rows = []


def row(is_right, *what):
    """Prints a row: whether it is right, and what it is."""
    _rows.append(bool(is_right))
    print("right:" if is_right else "wrong:", *what, flush=True)


def attempt(make):
    """Returns what make() returns, or the exception that it raises."""
    try:
        return make()
    except Exception as error:
        return error


def refuses(answer, *patterns, without=()):
    """Whether the answer of attempt() is a refusal whose text has all of the patterns, and none of those of without."""
    return isinstance(answer, (tvi.Error, TypeError, ValueError)) and \
        all(re.search(pattern, str(answer)) for pattern in patterns) and \
        not any(re.search(pattern, str(answer)) for pattern in without)


def told(answer):
    """An answer of attempt() as a text: an exception with its class."""
    return f"{type(answer).__name__}: {answer}" if isinstance(answer, Exception) else str(answer)


def verdict():
    print(sum(_rows), "of", len(_rows), "right")
