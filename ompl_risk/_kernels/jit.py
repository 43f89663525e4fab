"""The one decorator of all kernels, and the guard against a stale compilation cache."""

from __future__ import annotations

import contextlib
import hashlib
import json
import re
from pathlib import Path
from typing import Any

import numba


def _drop_stale_cache(folder: Path) -> None:
    """Delete compiled kernels whose source, or that of a kernel they call, has changed since.

    Numba looks only at the file of the outermost function, so a kernel that calls a changed
    kernel in another file would go on running the old code.
    """
    cache = folder / "__pycache__"
    stamp = cache / "kernels.json"
    present, before = _digests(folder), {}
    with contextlib.suppress(OSError, ValueError):
        before = json.loads(stamp.read_text())
    changed = {module for module, digest in present.items() if before.get(module) != digest}
    if not changed:
        return
    with contextlib.suppress(OSError):  # a read-only installation keeps its cache elsewhere
        cache.mkdir(exist_ok=True)
        for compiled in [*cache.glob("*.nbi"), *cache.glob("*.nbc")]:
            if compiled.name.split(".")[0] in changed:
                compiled.unlink(missing_ok=True)
        stamp.write_text(json.dumps(present))


def _digests(folder: Path) -> dict[str, str]:
    """For each module a digest of its source and of all kernel modules that it builds on."""
    sources = {path.stem: path.read_text() for path in sorted(folder.glob("*.py"))}
    uses = {
        module: {name for name in sources if re.search(rf"\b_kernels\b.*\b{name}\b", source)}
        for module, source in sources.items()
    }
    found = {}
    for module in sources:
        needed, new = {module}, {module}
        while new:
            new = set().union(*(uses[name] for name in new)) - needed
            needed |= new
        whole = [numba.__version__, *(sources[name] for name in sorted(needed))]
        found[module] = hashlib.sha256("\0".join(whole).encode()).hexdigest()
    return found


_drop_stale_cache(Path(__file__).parent)

entry = numba.njit(cache=True, nogil=True, error_model="numpy")
"""For kernels that Python calls: compiled on first call, kept on disk, GIL released."""

_no_counts: dict[str, Any] = {"_nrt": False}
kernel = numba.njit(cache=True, nogil=True, error_model="numpy", **_no_counts)
"""For kernels that kernels call: may not allocate. Without numba's reference counts (an atomic
instruction for every array that is touched) a distance query takes 0.17 us instead of 0.28 us."""

inlined = numba.njit(cache=True, nogil=True, error_model="numpy", forceinline=True, **_no_counts)
"""For kernels of numbers that loops over many vehicles call: part of the caller's code, so that
the compiler can do several rounds of the loop at a time."""
