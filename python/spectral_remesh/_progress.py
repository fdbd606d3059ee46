"""Reports the progress of a job to a function, or as a bar."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator

from ._errors import ArgumentError

#: A function that is called with the name of the stage and the completed share of the job, from 0 to 1, never decreasing.
Progress = Callable[[str, float], object]

#: The type of the argument ``progress``.
Wanted = bool | Progress | None

_WIDTH = 40


@contextlib.contextmanager
def told(progress: Wanted) -> Iterator[Progress | None]:
    """Yields the function to call during the job, if progress is wanted. A bar is cleared at the end."""
    if progress is None or progress is False:
        yield None
    elif progress is True:
        with _bar() as tell:
            yield tell
    elif callable(progress):
        yield progress
    else:
        raise ArgumentError("progress", "True, or a function of a stage and a fraction, is expected")


@contextlib.contextmanager
def _bar() -> Iterator[Progress]:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield _print_bar
        print("\r" + " " * (_WIDTH + 40) + "\r", end="", file=sys.stderr, flush=True)
        return
    with tqdm(total=100, leave=False, bar_format="{desc} |{bar}| {percentage:3.0f} % {elapsed}") as bar:

        def tell(stage: str, done: float) -> None:
            bar.set_description_str(f"{stage:26}", refresh=False)
            bar.n = 100 * done
            bar.refresh()

        yield tell


def _print_bar(stage: str, done: float) -> None:
    full = round(_WIDTH * done)
    bar = "#" * full + " " * (_WIDTH - full)
    print(f"\r{stage:26} |{bar}| {100 * done:3.0f} %", end="", file=sys.stderr, flush=True)
