"""The one way that numeric code is compiled: numba, cached on disk, IEEE arithmetic (no fast-math).

numba's own cache looks at the file of a function only, not at those of the functions that it calls; so the
cache's folder is named by a digest of every source that compiled code comes from, and a change compiles again.
"""

# mypy: allow-untyped-calls
# What is inherited from numba has no types.
from __future__ import annotations

import copy
import hashlib
import os
import stat
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import numba
import numpy as np
import platformdirs
from filelock import FileLock, Timeout
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.compiler_lock import global_compiler_lock
from numba.core.environment import Environment
from numba.core.registry import CPUDispatcher
from numba.core.sigutils import normalize_signature

import sim.code_library  # noqa: F401  # numba takes its libraries of code from there

FloatArray = np.ndarray[Any, np.dtype[np.float64]]
IntArray = np.ndarray[Any, np.dtype[np.int64]]
"""Double-precision array; the docstring of the function that takes or returns it says its shape."""

_P = ParamSpec("_P")
_R = TypeVar("_R")


_ABOVE = ("study", "rehearsal", "identification", "reproduction")
"""The packages that no compiled code calls into; numba tracks their own few functions itself."""


def cache_folder() -> Path:
    """Where the compiled code of these sources is kept: under NUMBA_CACHE_DIR, else the platform's cache folder.

    A user whose home is missing or read-only gets a folder of their own in the temporary directory.
    """
    room = Path(__file__).parent
    digest = hashlib.sha256()
    sources = [path for path in room.rglob("*.py") if path.relative_to(room).parts[0] not in _ABOVE]
    for path in sorted(sources):
        digest.update(path.relative_to(room).as_posix().encode() + b"\0" + path.read_bytes())
    base = os.environ.get("NUMBA_CACHE_DIR") or _users_folder() or _temporary_folder()
    return Path(base, f"compiled-{digest.hexdigest()[:16]}")


def _users_folder() -> str | None:
    """The platform's cache folder, if this user can write to it."""
    try:
        folder = platformdirs.user_cache_dir("becalm")
        os.makedirs(folder, exist_ok=True)
    except (RuntimeError, OSError):
        return None
    return folder if os.access(folder, os.W_OK | os.X_OK) else None


def _temporary_folder() -> str:
    """A folder that only this user can write to, since its code is run; shared by their processes if possible."""
    folder = Path(tempfile.gettempdir(), f"becalm-compiled-{os.getuid()}")
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
    except OSError:
        return tempfile.mkdtemp(prefix="becalm-compiled-")
    ours = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not stat.S_IMODE(found.st_mode) & 0o077
    return str(folder) if ours else tempfile.mkdtemp(prefix="becalm-compiled-")


numba.config.CACHE_DIR = str(cache_folder())  # type: ignore[attr-defined]  # numba fills its config at import


class _EntryFile(CompileResultCacheImpl):
    """Where the entry points of a function are kept: in files beside that of its code."""

    def get_filename_base(self, fullname: str, abiflags: str) -> str:
        return f"{super().get_filename_base(fullname, abiflags)}.entry"


class _EntryCache(FunctionCache):
    _impl_class = _EntryFile


class CompiledFunction(CPUDispatcher):
    """A function that gets an entry point for Python only when Python calls it.

    To take arguments from Python costs as much to compile as the function itself, and most functions are called from
    compiled code only.
    """

    _depth = 0
    """Of functions being compiled, each because the one before calls it; guarded by numba's lock."""

    def enable_caching(self) -> None:
        """Keep compiled code on disk."""
        super().enable_caching()
        self._entry_files = _EntryCache(self.py_func)
        self._entries: dict[tuple[Any, ...], Any] = {}  # numba's table of them keeps none alive

    @property
    def module(self) -> str:
        """Where it is defined."""
        return str(self.py_func.__module__)

    @property
    def size(self) -> int:
        """Of its source, as Python compiles it [bytes]."""
        return len(self.py_func.__code__.co_code)

    @property
    def is_compiled(self) -> bool:
        """Whether it has been compiled for arguments of some types, here or by another process of the same sources."""
        return bool(self.overloads) or self._index.exists()

    @property
    def _index(self) -> Path:
        """The file on disk that lists what it has been compiled for."""
        return Path(self._cache._cache_file._index_path)  # type: ignore[attr-defined]  # numba gives it as it caches

    def calls(self) -> Iterator[CompiledFunction]:
        """The compiled functions that it calls by their names."""
        for name in self.py_func.__code__.co_names:
            called = self.py_func.__globals__.get(name)
            if isinstance(called, CompiledFunction):
                yield called

    def add_overload(self, cres: Any) -> None:
        """Note the code for compiled callers; Python's get their entry point from `compile`."""
        self.overloads[tuple(cres.signature.args)] = cres

    def compile(self, sig: Any) -> Any:
        """Compile the function for arguments of these types; numba calls this for callers of both kinds."""
        with global_compiler_lock:
            called_from_python = CompiledFunction._depth == 0
            CompiledFunction._depth += 1
            try:
                return self._entry(sig) if called_from_python else super().compile(sig)
            finally:
                CompiledFunction._depth -= 1

    def _entry(self, sig: Any) -> Any:
        """What Python can call: from disk, else made around the compiled function."""
        args = tuple(normalize_signature(sig)[0])
        if args in self._entries:  # by another thread; twice in numba's table it would be ambiguous for ever
            return self._entries[args].entry_point
        entry = self._entry_files.load_overload(sig, self.targetctx)
        if entry is None:
            super().compile(sig)
            entry = _with_entry(self.overloads[args])
            self._entry_files.save_overload(sig, entry)
        self._entries[args] = entry
        self._insert([each._code for each in args], entry.entry_point, False)  # type: ignore[attr-defined]  # of C
        return entry.entry_point


def _with_entry(body: Any) -> Any:
    """The result of a compilation with an entry point, which takes Python's arguments and calls the function."""
    context = body.target_context.subtarget(enable_nrt=True)  # what comes from disk does not say so
    description = copy.copy(body.fndesc)
    description.env_name += ".entry"  # constants of its own: those of the function are on disk already
    environment = Environment.from_fndesc(description)
    library = context.codegen().create_library(f"{body.library.name}.entry")
    library.enable_object_caching()
    library.add_linking_library(body.library)
    with context.push_code_library(library):
        context.create_cpython_wrapper(library, description, environment, body.call_helper, _OPTIONS["nogil"])
    entry = context.get_executable(library, description, environment)
    return body._replace(library=library, fndesc=description, environment=environment, entry_point=entry)


_OPTIONS = {
    "nopython": True,
    "nogil": True,
    "error_model": "numpy",
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}

_LONGEST_COMPILATION = 300.0
"""After so long a process no longer waits for another that compiles [s]."""

INLINE: Any = {"forceinline": True}
"""The option of numba by which a function becomes part of those that call it."""


def compiled(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """A function of numbers, arrays and records, compiled at its first call.

    Bitwise repeatability over processes and machines of one architecture rests on the strict arithmetic.
    """
    return _defined(function, _OPTIONS)


def compiled_inline(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """As `compiled`, but made part of the compiled code that calls it: for what is called at every tick.

    An array costs seven numbers to hand on, and a loop of known length can be unrolled only where its length is known.
    """
    return _defined(function, {**_OPTIONS, **INLINE})


def _defined(function: Callable[_P, _R], options: Mapping[str, Any]) -> Callable[_P, _R]:
    result = CompiledFunction(function, targetoptions=dict(options))
    result.enable_caching()
    _functions.append(result)
    return cast(Callable[_P, _R], result)


_functions: list[CompiledFunction] = []


def compiled_functions() -> list[CompiledFunction]:
    """All that have been defined until now, whether compiled or not yet."""
    return list(_functions)


def reached_from(functions: Iterable[Callable[..., Any]]) -> frozenset[CompiledFunction]:
    """These functions, which are compiled ones, and all that they call, and so on."""
    found: set[CompiledFunction] = set()
    waiting = [each for each in functions if isinstance(each, CompiledFunction)]
    while waiting:
        function = waiting.pop()
        if function not in found:
            found.add(function)
            waiting += function.calls()
    return frozenset(found)


@contextmanager
def compiling_alone() -> Iterator[None]:
    """Let one process compile what several need at once: the others wait, and then have it from disk.

    Where no lock can be had each compiles for itself.
    """
    lock = FileLock(Path(numba.config.CACHE_DIR, "compiling.lock"), timeout=_LONGEST_COMPILATION)  # type: ignore[attr-defined]
    try:
        lock.acquire()
    except (OSError, NotImplementedError, Timeout):
        yield
        return
    try:
        yield
    finally:
        lock.release()
