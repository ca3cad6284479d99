"""Whether Python goes on while the library computes."""

import threading
from collections.abc import Callable

ENOUGH = 20_000


def counts_on_during(work: Callable[[], object]) -> bool:
    """Tell whether this thread counts to ENOUGH while one single call of `work` is still under way in another."""
    started, finished = threading.Event(), threading.Event()

    def run() -> None:
        started.set()
        work()
        finished.set()

    worker = threading.Thread(target=run)
    worker.start()
    started.wait()
    progress = 0
    while progress < ENOUGH and not finished.is_set():
        progress += 1
    still_running = not finished.is_set()
    worker.join()
    return progress == ENOUGH and still_running
