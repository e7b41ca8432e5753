"""How much of what a mission runs has been compiled: a first start takes a while, and who waits wants to see that."""

from __future__ import annotations

from functools import cache

from sim.capture.tick_loop import control_tick, fly, know, write_tick
from sim.compiled import CompiledFunction, compiled_functions, reached_from
from sim.config import Engine, MissionConfig
from sim.method.method import method_of
from sim.plant.engine import ENGINES
from sim.plant.plant import kernels_in


def compiled_share(config: MissionConfig, *, simulated: bool = True) -> float:
    """How much of what a mission in that engine and of that method runs is compiled, from 0 to 1, by its size.

    For any thread. What another process of the same sources has compiled counts: it is there to be loaded.

    Args:
        config: of the mission.
        simulated: whether its plant is that engine; else it is one that Python steps, such as a robot.

    """
    method = method_of(config).handle.__module__.rpartition(".")[0]
    functions = _functions(config.simulation.engine if simulated else None, method)
    sizes = {function: function.size for function in functions}
    return sum(size for function, size in sizes.items() if function.is_compiled) / sum(sizes.values())


@cache
def _functions(engine: Engine | None, method: str) -> frozenset[CompiledFunction]:
    """The tick loop, the plant of that engine, the method in that package, and all that they call."""
    plant = None if engine is None else ENGINES[engine].__module__
    own = [each for each in compiled_functions() if each.module.startswith(f"{method}.")]
    kernels = [] if plant is None else kernels_in(plant)
    return reached_from([control_tick if engine is None else fly, know, write_tick, *own, *kernels])
