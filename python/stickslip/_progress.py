"""Progress bars of computations, drawn by tqdm in terminals and notebooks."""

from __future__ import annotations

from importlib import import_module
from typing import Any, Optional

__all__ = ["Bars"]


class Bars:
    """The bars of one computation: one for each of its parts, such as the two parts of a search."""

    def __init__(self) -> None:
        try:
            # The bar of a notebook or that of a terminal.
            self._tqdm = import_module("tqdm.auto").tqdm
        except ModuleNotFoundError as error:
            remedy = 'progress=True needs tqdm: pip install "stickslip[progress]"'
            raise ModuleNotFoundError(remedy, name="tqdm") from error
        self._part = 0
        self._bar: Optional[Any] = None

    def draw(self, part: int, study: str, runs: int, most_runs: int, at_rest: int, failed: int) -> None:
        """Draws the counts of a part, with a new bar for a new part; tqdm limits the rate."""
        if part < self._part:
            # Its last state was drawn before the next part.
            return
        if part > self._part:
            self.close()
            self._part = part
            self._bar = self._tqdm(total=most_runs, desc=study, unit=" runs")
        bar = self._bar
        if bar is None:
            return
        # The number of runs that are needed at most may decrease.
        bar.total = most_runs
        bar.set_postfix({"at rest": at_rest, **({"failed": failed} if failed else {})}, refresh=False)
        bar.update(runs - bar.n)

    def close(self) -> None:
        """Leaves the last state of the bar."""
        if self._bar is not None:
            self._bar.refresh()
            self._bar.close()
            self._bar = None
