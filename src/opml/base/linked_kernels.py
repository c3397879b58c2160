"""A compiler of kernels that other kernels call, which ends before machine code.

Numba optimises and translates a kernel with all that it calls, and both again wherever it is called: a leaf
as often as the tree of calls is high. Here its code is passed on as it is, and Numba does the rest once,
where an entry links it.
"""

from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import NativeLowering


class LinkedKernels(CompilerBase):
    """Numba's compiler, whose last step makes code to link; kernels of it cannot be called from Python."""

    def define_pipelines(self) -> list[Any]:
        """Return the passes."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.passes = [
            (_Lowering if each is NativeLowering else each, text) for each, text in passes.passes
        ]
        return [passes]


@register_pass(mutates_CFG=True, analysis_only=False)
class _Lowering(NativeLowering):
    """Numba's pass from types to LLVM's code, without a function for Python behind it."""

    _name = "lowering_to_link"

    def run_pass(self, state: Any) -> bool:
        state.flags.no_compile = True
        super().run_pass(state)
        _link(state.library)
        # Callers find the kernel by this object; a dispatcher takes no other than a built-in function.
        state["cr"] = lowered = state["cr"]._replace(cfunc=[].append)
        state.targetctx.insert_user_function(lowered.cfunc, lowered.fndesc, [state.library])
        return True


def _link(library: JITCodeLibrary) -> None:
    """Complete the code of a kernel by that of all it calls, neither optimised nor translated."""
    for other in dict.fromkeys(library._linking_libraries):
        library._reload_init.update(other._reload_init)
        library._final_module.link_in(other._get_module_for_linking(), preserve=True)
    library._finalized = True
