"""The cache of one kernel: what was compiled is loaded with as little work as running it takes.

numba's own cache makes the compiler ready before it looks for a kernel, and reads with the code
the intermediate code that other kernels are compiled with.  A run that finds all its kernels needs
neither.  Here both wait until something has to be compiled.
"""

from __future__ import annotations

import pickle
from typing import Any, Self

from llvmlite import binding as llvm
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompileResult
from numba.core.runtime import rtsys

#: Marks what is kept in this way, beside what numba keeps of kernels that need more.
MARK = "drystone 1"


class KernelCache(FunctionCache):
    """What `numba` asks for a kernel that was compiled before, and gives one that it has compiled.

    Parameters
    ----------
    py_func
        The kernel as it was written.
    """

    def __init__(self, py_func: Any) -> None:
        self._py_func = py_func
        self._ready = False

    def __getattr__(self, name: str) -> Any:
        """The files of the kernel, found when they are first needed: most kernels of the package
        are called by no run."""
        if self.__dict__.get("_ready", True):
            raise AttributeError(name)
        self._ready = True
        super().__init__(self._py_func)
        return getattr(self, name)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The kernel compiled for a signature, or None; without making the compiler ready, which
        it does by itself before it compiles."""
        rtsys.initialize(target_context)  # what kernels call for memory
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)


class _Kept(CompileResultCacheImpl):
    """How a kernel becomes what is kept, and again a kernel."""

    def reduce(self, cres: Any) -> tuple[Any, ...]:
        """What is kept of a compiled kernel.

        The environment of a function that was compiled into it is left out where it holds no
        constant: the code reads nothing else there.
        """
        payload = cres._reduce()
        (name, kind, code), description, environment, signature = payload[:4]
        objectmode, lifted, _, reload, others = payload[4:]
        if objectmode or lifted or reload or kind != "object":
            return payload
        others = [other for other in others if other.consts]
        return MARK, name, *code, pickle.dumps((description, environment, signature, others))

    def rebuild(self, target_context: Any, payload: tuple[Any, ...]) -> Any:
        """The kernel, ready to be called."""
        if payload[0] != MARK:
            return super().rebuild(target_context, payload)
        _, name, code, intermediate, rest = payload
        description, environment, signature, others = pickle.loads(rest)
        codegen = target_context.codegen()
        library = _Code.of(codegen, name, code, intermediate, description)
        entry_point = target_context.get_executable(library, description, environment)
        for other in others:
            codegen.set_env(other.env_name, other)
        return CompileResult(
            target_context=target_context,
            typing_context=target_context.typing_context,
            library=library,
            environment=environment,
            entry_point=entry_point,
            fndesc=description,
            type_annotation="",
            signature=signature,
            objectmode=False,
            lifted=(),
            typing_error=None,
            call_helper=None,
            metadata=None,
            reload_init=(),
            referenced_envs=others,  # which live as long as the code
        )


KernelCache._impl_class = _Kept


class _Code(JITCodeLibrary):
    """Machine code from the cache; its intermediate code is read when something links with it."""

    _intermediate = b""
    _shared_module: Any

    @classmethod
    def of(cls, codegen: Any, name: str, code: bytes, intermediate: bytes, described: Any) -> Self:
        self = cls(codegen, name)
        self._intermediate = intermediate
        self.enable_object_caching()
        self._set_compiled_object(code)
        self._finalize_final_module()
        codegen._engine._defined_symbols |= {
            described.llvm_func_name,
            described.llvm_cpython_wrapper_name,
        }
        return self

    def _get_module_for_linking(self) -> Any:
        if self._shared_module is None:
            self._shared_module = llvm.parse_bitcode(self._intermediate)
            self._codegen._engine._load_defined_symbols(self._shared_module)
        return self._shared_module
