"""Where compiled code is kept, by the user's folder or where nobody else can put any; and how it is put together."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import tempfile
from pathlib import Path
from textwrap import dedent

import platformdirs
import pytest
from numba import types

from server.settings import Settings
from sim import code_library, compiled
from sim.errors import ConfigError


def _no_home(*_: object, **__: object) -> str:
    raise RuntimeError("could not determine the home directory")


@pytest.fixture
def homeless(monkeypatch, tmp_path):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setattr(platformdirs, "user_cache_dir", _no_home)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def test_a_user_without_a_home_has_a_folder_of_their_own(homeless):
    folder = compiled.cache_folder().parent
    assert folder == homeless / f"becalm-compiled-{os.getuid()}" == compiled.cache_folder().parent
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700


def test_a_home_that_cannot_be_written_is_none(homeless, monkeypatch):
    (homeless / "file").write_text("")
    monkeypatch.setattr(platformdirs, "user_cache_dir", lambda _: str(homeless / "file" / "cache"))
    assert compiled.cache_folder().parent.name.startswith("becalm-compiled-")


@pytest.mark.parametrize("strange", ["open", "link"])
def test_a_folder_into_which_others_may_put_code_is_not_used(homeless, strange):
    there = homeless / f"becalm-compiled-{os.getuid()}"
    if strange == "open":
        there.mkdir()
        there.chmod(0o777)
    else:
        (homeless / "theirs").mkdir()
        there.symlink_to(homeless / "theirs")
    folder = compiled.cache_folder().parent
    assert folder != there
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700


def test_without_a_home_a_data_folder_must_be_named(monkeypatch):
    monkeypatch.setattr("server.settings.user_data_path", _no_home)
    with pytest.raises(ConfigError, match="no home") as refused:
        Settings()
    assert "BECALM_DATA_DIR" in refused.value.tip
    assert Settings(data_dir=Path("here")).data_dir == Path("here")


LAYERS = """
    from typing import NamedTuple
    import numpy as np
    from sim.compiled import compiled

    class Pair(NamedTuple):
        values: np.ndarray
        total: float

    @compiled
    def half(x):
        return 0.5 * x

    @compiled
    def spread(n, start):
        values = np.zeros(n)
        if n > 5:
            raise ValueError("five at most")
        for i in range(n):
            for j in range(n):
                values[i] += half(start) * np.sin(i + j) / np.hypot(i + 1.0, j + 1.0)
        values[0], values[-1] = values[-1], values[0]
        total = np.sum(values * values) + np.max(values) - np.min(values)
        return Pair(values, total)

    @compiled
    def through(n, start):
        return spread(n, start).total + half(start)

    @compiled
    def beside(n, start):
        return spread(n, 2.0 * start).total
"""

USE = """
    import sys
    import numpy as np
    from numba.core import event
    import layers

    class Compiling(event.Listener):
        names = []
        def on_start(self, event):
            self.names.append(event.data["dispatcher"].py_func.__name__)
        def on_end(self, event):
            pass

    event.register("numba:compile", Compiling())
    calls = [
        lambda: layers.through(4, 1.5),
        lambda: layers.beside(4, 1.5),
        lambda: layers.spread(4, 3.0).total,
        lambda: layers.half(3.0),
        lambda: type(layers.spread(3, 1.0)).__name__ + str(layers.spread(3, 1.0).values.dtype),
    ]
    calls = [calls[int(place)] for place in sys.argv[1]]
    print(sorted(str(call()) for call in calls))
    try:
        layers.through(6, 1.0)
    except ValueError as error:
        print(error)
    print(sorted(name for name in Compiling.names if hasattr(layers, name)))
"""


def test_functions_call_each_other_and_are_compiled_once_for_all_processes(tmp_path):
    (tmp_path / "layers.py").write_text(dedent(LAYERS))
    (tmp_path / "use.py").write_text(dedent(USE))
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(Path(__file__).parents[2])}

    def use(calls: str) -> list[str]:
        command = [sys.executable, str(tmp_path / "use.py"), calls]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300, check=True)
        return done.stdout.splitlines()

    assert use("0")[1:] == ["five at most", "['half', 'spread', 'through']"]
    values, refusal, compiled_next = use("01234")
    assert compiled_next == "['beside']"
    assert refusal == "five at most"
    assert "Pairfloat64" in values
    assert use("01234") == use("43210") == [values, refusal, "[]"]


INLINED = """
    import numpy as np
    from sim.compiled import compiled, compiled_inline

    @compiled_inline
    def long_one(x):
        total = np.zeros(3)
        for i in range(3):
            total[i] = np.sin(x + i) * np.cos(x - i) / np.hypot(x, i + 1.0) + np.tan(x) * np.exp(-x * i)
        return total[0] * total[1] + total[2] * np.max(total) - np.sum(total * total)

    @compiled
    def caller(x):
        return long_one(x) + long_one(2.0 * x)

    if __name__ == "__main__":
        caller(0.5)
        (result,) = caller.overloads.values()
        (inner,) = long_one.overloads.values()
        print(len(str(inner.library.get_function(inner.fndesc.llvm_func_name)).splitlines()))
        print(inner.fndesc.llvm_func_name in {each.name for each in result.library._final_module.functions})
"""


def test_what_is_to_be_inlined_is_part_of_its_callers_at_any_length(tmp_path):
    (tmp_path / "inlined.py").write_text(dedent(INLINED))
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(Path(__file__).parents[2])}
    command = [sys.executable, str(tmp_path / "inlined.py")]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300, check=True)
    lines, called_by_symbol = done.stdout.split()
    assert int(lines) > code_library.INLINED
    assert called_by_symbol == "False"


@compiled.compiled
def _doubled(x: float) -> float:
    return 2.0 * x


def test_a_function_that_two_threads_call_first_is_compiled_for_both(monkeypatch):
    assert _doubled(1.0) == 2.0
    assert isinstance(_doubled, compiled.CompiledFunction)
    _doubled.compile((types.float64,))  # as the thread does that was late

    def found_again(_self, signature):
        raise AssertionError(f"numba looks for {signature} at every call")

    monkeypatch.setattr(compiled.CompiledFunction, "compile", found_again)
    assert _doubled(3.0) == 6.0
