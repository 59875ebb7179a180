"""An existing Dask scheduler as an executor."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

from crankmbs.errors import InputError

__all__ = ["cluster_executor"]

_PATIENCE = 5  # s


@contextmanager
def cluster_executor(address: str) -> Iterator[Executor]:
    """The executor of a scheduler at an address such as "tcp://host:8786".

    Raises
    ------
    InputError : the extra ``cluster`` is not installed, no scheduler answers within seconds, or it
        has no workers
    """
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            'a cluster needs Dask, which the extra cluster brings: pip install "crankmbs[cluster]"'
        ) from None
    try:
        client = Client(address, timeout=_PATIENCE)
    except (OSError, ValueError, TimeoutError):
        raise InputError(
            f'{address}: no scheduler answers; start one with "dask scheduler", and give its '
            "address, such as tcp://host:8786"
        ) from None
    with client:
        if not client.scheduler_info()["workers"]:
            raise InputError(
                f'{address}: this scheduler has no workers; start some with "dask worker {address}"'
            )
        yield client.get_executor(pure=False)
