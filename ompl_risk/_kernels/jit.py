"""The one decorator of all kernels, and the guard against a stale compilation cache."""

from __future__ import annotations

import contextlib
import hashlib
from pathlib import Path
from typing import Any

import numba


def _drop_stale_cache(folder: Path) -> None:
    """Delete compiled kernels if any kernel source has changed since they were compiled.

    Numba looks only at the file of the outermost function, so a kernel that calls a changed
    kernel in another file would go on running the old code.
    """
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(folder.glob("*.py")):
        digest.update(source.read_bytes())
    cache = folder / "__pycache__"
    stamp = cache / "kernels.sha256"
    if stamp.exists() and stamp.read_text() == digest.hexdigest():
        return
    with contextlib.suppress(OSError):  # a read-only installation keeps its cache elsewhere
        cache.mkdir(exist_ok=True)
        for compiled in [*cache.glob("*.nbi"), *cache.glob("*.nbc")]:
            compiled.unlink(missing_ok=True)
        stamp.write_text(digest.hexdigest())


_drop_stale_cache(Path(__file__).parent)

entry = numba.njit(cache=True, nogil=True, error_model="numpy")
"""For kernels that Python calls: compiled on first call, kept on disk, GIL released."""

_no_counts: dict[str, Any] = {"_nrt": False}
kernel = numba.njit(cache=True, nogil=True, error_model="numpy", **_no_counts)
"""For kernels that kernels call: may not allocate. Without numba's reference counts (an atomic
instruction for every array that is touched) a distance query takes 0.17 us instead of 0.28 us."""
