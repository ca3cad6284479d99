"""The one way along a load path, whatever takes the loads."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Generic, Protocol, TypeVar

from comminute.runs.load_path import Load, LoadPath
from comminute.runs.outcomes import Outcome

R_co = TypeVar("R_co", covariant=True)
O_co = TypeVar("O_co", bound=Outcome, covariant=True)  # an outcome, with what its engine adds


class Walker(Protocol[O_co]):
    """Engine that takes a packing through loads one after another: the continuum's, or a lattice.

    It holds the packing; which loads there are, what is kept of them and when to stop is the `PathRun`'s.
    """

    def load(self, load: Load, *, with_fabric: bool) -> O_co:
        """Take the packing through one load.

        The next load starts from the state after this one. Without `with_fabric` the walker may leave the fabric out
        of the outcome, and need not compute it; that changes no bit of any other number.
        """
        ...

    def remix(self) -> None:
        """Mix the packing anew before the next load."""
        ...


class PathRun(Generic[O_co, R_co]):
    """Run along a load path: an iterator over the outcomes of its loads, which keeps them as they are finished.

    Wherever the iteration ends, at the last load or at a Ctrl-C, `result` has what is finished, and a run that is
    given those loads as `finished` goes on after them. A stopped run itself does not: its packing is between loads.

    Parameters
    ----------
    walker : Walker
        Its packing is as after the finished loads, remixed where the last of them asks for that.
    path : LoadPath
        All loads, the finished ones among them.
    result_of : callable
        Makes the result of finished outcomes, at least one.
    wanted : frozenset of int
        Indices of the loads whose fabric is kept.
    keep_latest : bool
        Keep the fabric of the latest load until the next is finished: a result so far can then be gone on from.
    finished : iterable of Outcome
        Outcomes of the first loads, from an earlier run.
    """

    def __init__(
        self,
        walker: Walker[O_co],
        path: LoadPath,
        result_of: Callable[[Sequence[O_co]], R_co],
        *,
        wanted: frozenset[int],
        keep_latest: bool = False,
        finished: Iterable[O_co] = (),
    ) -> None:
        self._walker = walker
        self._path = path
        self._result_of = result_of
        self._wanted = wanted
        self._keep_latest = keep_latest
        self._outcomes = list(finished)

    def __iter__(self) -> Iterator[O_co]:
        """Take load after load, and give the outcome of each when the packing is ready for the next one."""
        for load in self._path.loads(first=len(self._outcomes)):
            with_fabric = self._keep_latest or load.place in self._wanted
            self._outcomes.append(self._walker.load(load, with_fabric=with_fabric))
            self._drop_fabric(load.place - 1 if self._keep_latest else load.place)
            if load.remixed:
                self._walker.remix()
            yield self._outcomes[load.place]

    def result(self) -> R_co | None:
        """Make the result of the finished loads; None before the first is finished."""
        return self._result_of(self._outcomes) if self._outcomes else None

    def _drop_fabric(self, index: int) -> None:
        if index not in self._wanted and index >= 0 and self._outcomes[index].fabric is not None:
            self._outcomes[index] = replace(self._outcomes[index], fabric=None)
