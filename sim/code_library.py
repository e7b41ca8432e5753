"""Machine code of compiled functions: each is compiled once, and called by the others by its symbol.

numba copies the code of every function into all that call it, and theirs into their callers: what stands seven calls
deep is optimized and translated seven times. Here a function that LLVM would not inline stays in a library of its
own, which its callers refer to; only small ones are copied, so that they can be inlined. What is inlined at any size is
optimized and translated where it is inlined, and nowhere else. The arithmetic is the same.

This rests on the code libraries of one version of numba, to which `pyproject.toml` holds it.
"""

# mypy: allow-untyped-calls
# What is inherited from numba has no types.
from __future__ import annotations

import itertools
import secrets
import uuid
import weakref
from typing import Any, ClassVar, NamedTuple

import llvmlite.binding as llvm
from numba.core.bytecode import FunctionIdentity
from numba.core.codegen import JITCodeLibrary
from numba.core.environment import lookup_environment
from numba.core.registry import cpu_target

INLINED = 150
"""Lines of LLVM's language up to which a function is copied into its callers; LLVM itself inlines less than that."""


class _Stored(NamedTuple):
    """One library as it is kept on disk."""

    identity: str
    name: str
    machine_code: bytes
    """Empty of what is only ever inlined."""
    bitcode: bytes
    copied: bool
    environments: list[Any]


class CodeLibrary(JITCodeLibrary):
    """The code of one compiled function, with the libraries that it calls into."""

    _loaded: ClassVar[weakref.WeakValueDictionary[str, CodeLibrary]] = weakref.WeakValueDictionary()

    def __init__(self, codegen: Any, name: str, identity: str | None = None) -> None:
        super().__init__(codegen, name)
        self._identity = identity or uuid.uuid4().hex
        self._called: dict[CodeLibrary, None] = {}
        self._environments: list[Any] = []
        self._machine_code: bytes | None = None
        self._copied: bool | None = None
        self._inline: bool | None = None
        self._loaded[self._identity] = self

    @property
    def copied(self) -> bool:
        """Whether callers get a copy: also of what is to be inlined at any size, or is never stored on its own."""
        if not self._object_caching_enabled:
            return True
        if self._copied is None:
            defined = [each for each in self.get_defined_functions() if not each.name.startswith("NRT_")]
            self._copied = self.inline or sum(str(each).count("\n") for each in defined) <= INLINED
        return self._copied

    @property
    def inline(self) -> bool:
        """Whether it becomes part of whatever calls it, and never runs on its own."""
        if self._inline is None:
            self._inline = self._object_caching_enabled and any(map(_is_inline, self.get_defined_functions()))
        return self._inline

    def add_linking_library(self, library: Any) -> None:
        """Let code of another library be called: a copy of it if it is small, else by its symbol."""
        super().add_linking_library(library)
        if isinstance(library, CodeLibrary):
            self._called.update(library._called)
            if not library.copied:
                self._called[library] = None

    def _get_module_for_linking(self) -> Any:
        """What is copied into a caller."""
        if self.copied:
            return super()._get_module_for_linking()
        return llvm.parse_assembly(str(self._codegen._create_empty_module(self.name)))

    def _optimize_functions(self, ll_module: Any) -> None:
        """Optimize each function; numba sets this up again for each, also for those that are only declared."""
        ll_module.data_layout = self._codegen._data_layout
        passes, builder = self._codegen._function_pass_manager()
        for function in ll_module.functions:
            if not function.is_declaration:
                passes.run(function, builder)

    def _optimize_final_module(self) -> None:
        if not self.inline:
            super()._optimize_final_module()

    def _finalize_final_module(self) -> None:
        """Have it translated; of what is only ever inlined, just where its environments stand."""
        if not self.inline:
            super()._finalize_final_module()
            return
        environments = _environments_of(self._shared_module or self._final_module)
        module = llvm.parse_assembly(str(self._codegen._create_empty_module(self.name)))
        module.link_in(llvm.parse_assembly("\n".join(map(str, environments))))
        self._codegen._add_module(module)
        self._codegen._engine.finalize_object()
        self._finalized = True

    def _verify_declare_only_symbols(self) -> None:
        for function in self._final_module.functions:
            if function.is_declaration and function.name.startswith("_ZN5numba"):
                assert self._codegen._engine.is_symbol_defined(function.name), f"{function.name} is not linked"

    def serialize_using_object_code(self) -> tuple[str, str, tuple[_Stored, list[_Stored]]]:
        """The library and all that it calls into, as numba's cache keeps them."""
        self._ensure_finalized()
        return self.name, "by symbol", (self._stored(), [library._stored() for library in self._called])

    def _stored(self) -> _Stored:
        if self._machine_code is None:
            self._machine_code = b"" if self.inline else self._get_compiled_object()
        bitcode = super()._get_module_for_linking().as_bitcode()
        return _Stored(self._identity, self.name, self._machine_code, bitcode, self.copied, self._referenced())

    def _referenced(self) -> list[Any]:
        """The environments (globals and constants of Python) that the code refers to."""
        names = [each.name for each in _environments_of(self._final_module)]
        found = [environment for name in names if (environment := lookup_environment(name)) is not None]
        return [environment for environment in found if environment.can_cache()] or self._environments

    @classmethod
    def _unserialize(cls, codegen: Any, state: tuple[str, str, tuple[_Stored, list[_Stored]]]) -> CodeLibrary:
        """The library that was stored; those that it calls into are loaded before it, each once a process."""
        own, called = state[2]
        loaded = [cls._load(codegen, stored) for stored in called]
        library = cls._load(codegen, own)
        library._called.update(dict.fromkeys(loaded))
        return library

    @classmethod
    def _load(cls, codegen: Any, stored: _Stored) -> CodeLibrary:
        if (known := cls._loaded.get(stored.identity)) is not None:
            return known
        self = cls(codegen, stored.name, stored.identity)
        self._machine_code, self._copied, self._environments = stored.machine_code, stored.copied, stored.environments
        self._inline = not stored.machine_code
        self.enable_object_caching()
        if not self._inline:
            self._set_compiled_object(stored.machine_code)
        self._shared_module = llvm.parse_bitcode(stored.bitcode)
        self._finalize_final_module()
        if not self._inline:
            codegen._engine._load_defined_symbols(self._shared_module)
        for environment in self._environments:
            codegen.set_env(environment.env_name, environment)
        return self


def _environments_of(module: Any) -> list[Any]:
    """The variables of a module that environments (globals and constants of Python) are reached by."""
    return [each for each in module.global_variables if each.name.startswith("_ZN08NumbaEnv")]


def _is_inline(function: Any) -> bool:
    """Whether it is the library's own, no copy, and numba was told to make it part of its callers (`forceinline`)."""
    return function.linkage == llvm.Linkage.external and b"alwaysinline" in b" ".join(function.attributes)


cpu_target.target_context.codegen()._library_class = CodeLibrary
# numba numbers the symbols of each process from 1; those that come from disk must not be taken for this one's.
FunctionIdentity._unique_ids = itertools.count(secrets.randbits(60))
