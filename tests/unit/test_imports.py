"""Logs from elsewhere: what becomes of them, and what is asked about."""

import io
import json
from functools import cache

import numpy as np
import pytest
from mcap.writer import Writer

from server.fits.recorded import recorded_plan
from server.imports.library import imported
from server.imports.mapping import log_map
from server.library.runs import RunStore
from server.log.ros import header, ros, ros_schema, serialized
from sim.capture.playback import Playback
from sim.errors import ConfigError, MissionRefused
from sim.identification.fit import fit

MAP = """
configuration = "testbed"
[time]
source = "t"
[joint_angle]
left = ["q1", "q2", "q3"]
right = ["q4", "q5", "q6"]
[commanded_joint_rate]
left = ["u1", "u2", "u3"]
right = ["u4", "u5", "u6"]
[base_pose]
x = "bx"
y = "by"
angle = "ba"
[target_pose]
x = "tx"
y = "ty"
angle = "ta"
[left_wrench]
x = "lx"
y = "ly"
torque = "lt"
[right_wrench]
x = "rx"
y = "ry"
torque = "rt"
frame = "world"
"""


@cache
def flown():
    """Ticks of a run in which the target is struck once."""
    from tests.unit.test_identification import ticks  # noqa: PLC0415 - flies when it is asked for

    return ticks()


def columns() -> dict[str, np.ndarray]:
    """The run as a laboratory's own table, with a clock of its own."""
    rows = flown()
    table = {"t": 1000.0 + rows["time"]}
    for joint in range(6):
        table[f"q{joint + 1}"] = rows["joint_angle"].reshape(-1, 6)[:, joint]
        table[f"u{joint + 1}"] = rows["commanded_joint_rate"].reshape(-1, 6)[:, joint]
    for name, field in (("b", "base_pose"), ("t", "target_pose")):
        seen = np.where(np.arange(len(rows))[:, None] % 2 == 0, rows[field], np.nan)  # pictures come half as often
        table |= {f"{name}{axis}": seen[:, place] for place, axis in enumerate("xya")}
    for arm, name in enumerate("lr"):
        wrench = rows["hand_wrench"][:, arm].copy()
        if name == "l":
            c, s = np.cos(rows["hand_pose"][:, arm, 2]), np.sin(rows["hand_pose"][:, arm, 2])
            wrench[:, :2] = np.stack([c * wrench[:, 0] + s * wrench[:, 1], c * wrench[:, 1] - s * wrench[:, 0]], axis=1)
        table |= {f"{name}{axis}": wrench[:, place] for place, axis in enumerate("xyt")}
    return table


def write(path, table):
    with path.open("w") as file:
        file.write(",".join(table) + "\n")
        for row in zip(*table.values(), strict=True):
            file.write(",".join("" if np.isnan(value) else repr(float(value)) for value in row) + "\n")
    return path


@pytest.fixture
def store(tmp_path):
    return RunStore(tmp_path / "runs").make_root()


def take(store, tmp_path, table, map_text=MAP):
    return imported(store, write(tmp_path / "log.csv", table), map_text, "log.csv")


def rows_of(store, done):
    return np.concatenate(list(store.read(done.run).chunks()))


def test_a_table_becomes_a_run_with_the_same_motion(store, tmp_path):
    done = take(store, tmp_path, columns())
    record, rows, true = store.read(done.run).record, rows_of(store, done), flown()
    assert (record.kind, record.status, record.ticks) == ("imported", "finished", len(true))
    for name in ("joint_angle", "commanded_joint_rate"):
        assert rows[name] == pytest.approx(true[name], abs=1e-9), name
    assert rows["base_pose"] == pytest.approx(true["base_pose"], abs=3e-3)
    assert rows["hand_wrench"] == pytest.approx(true["hand_wrench"], abs=5e-3)
    assert np.isnan(rows["target_perceived_pose"][1::2]).all()
    assert not done.notices or all("not numbers" in notice for notice in done.notices)


def test_it_is_replayed_as_any_other(store, tmp_path):
    reader = store.read(take(store, tmp_path, columns()).run)
    playback = Playback(reader.history(), reader.chunks)
    snapshot = playback.at(2.0)
    assert snapshot.target.pose[2] == pytest.approx(flown()["target_pose"][400, 2], abs=1e-3)


def test_it_is_fitted_as_any_other(store, tmp_path):
    done = take(store, tmp_path, columns())
    names = ["contact.stiffness", "robot.servo.time_constant", "target.inertia", "table.drag", "contact.friction"]
    result = fit(recorded_plan([store.read(done.run)], names))
    found = {each.name: each.value for each in result.parameters}
    assert found["contact.stiffness"] == pytest.approx(1100.0, rel=0.05)
    assert found["robot.servo.time_constant"] == pytest.approx(0.004, rel=0.02)


def test_a_log_without_commands_is_imported_and_not_fitted(store, tmp_path):
    without = MAP.replace(MAP[MAP.index("[commanded") : MAP.index("[base_pose]")], "")
    done = take(store, tmp_path, columns(), without)
    assert any("no commands" in notice for notice in done.notices)
    with pytest.raises(MissionRefused, match="commanded_joint_rate is not in its log"):
        recorded_plan([store.read(done.run)])


def test_gaps_clock_steps_and_holes_are_reported(store, tmp_path):
    table = {name: np.concatenate([values[:300], values[400:]]) for name, values in columns().items()}
    table["t"][500] -= 1.0
    table["lx"][600:620] = np.nan
    done = take(store, tmp_path, table)
    told = " ".join(done.notices)
    assert "1 gaps, the longest of 0.505 s" in told
    assert "steps back 1 times" in told
    assert "lx: 20 of" in told
    assert np.max(np.diff(rows_of(store, done)["tick"])) > 90
    assert "imported from log.csv" in (store.read(done.run).record.note or "")


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({f"q{j}": 57.3 for j in range(1, 7)}, "joint_angle: .* are these degrees"),
        ({f"u{j}": 57.2958 for j in range(1, 7)}, "commanded_joint_rate: .* are the commands degrees a second"),
        ({"ta": 57.3}, "target_pose.angle: .* are these degrees"),
        ({"bx": 1000.0, "by": 1000.0, "tx": 1000.0, "ty": 1000.0}, "are these millimetres"),
    ],
)
def test_units_that_cannot_be_right_are_asked_about(store, tmp_path, changed, words):
    table = {name: values * changed.get(name, 1.0) for name, values in columns().items()}
    with pytest.raises(ConfigError, match=words):
        take(store, tmp_path, table)
    assert not list(store.root.iterdir()), "nothing is left of it"


def test_degrees_that_are_said_are_taken(store, tmp_path):
    table = {name: values * (np.rad2deg(1.0) if name[0] in "qu" else 1.0) for name, values in columns().items()}
    said = MAP.replace("[commanded_joint_rate]", 'unit = "deg"\n[commanded_joint_rate]\nunit = "deg"')
    rows = rows_of(store, take(store, tmp_path, table, said))
    assert rows["joint_angle"] == pytest.approx(flown()["joint_angle"], abs=1e-9)


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ('"q1"', '"q9"', "has no column q9; there is"),
        ('source = "t"', 'source = "tx"', r"tx|samples|apart"),
        ("[base_pose]", "[base_poses]", "base_pose"),
        ('configuration = "testbed"', 'configuration = "bed"', "bed"),
        ('configuration = "testbed"', 'configuration = "published"', "control.period"),
        ("[time]", "[time", "map: "),
    ],
)
def test_what_is_wrong_in_a_map_is_named(store, tmp_path, before, after, words):
    with pytest.raises(ConfigError, match=words):
        take(store, tmp_path, columns(), MAP.replace(before, after))


def test_text_in_a_column_is_named(store, tmp_path):
    path = write(tmp_path / "log.csv", columns())
    path.write_text(path.read_text().replace("\n1000.0,", "\nnoon,", 1))
    with pytest.raises(ConfigError, match="column t holds what is no number"):
        imported(store, path, MAP, "log.csv")
    (tmp_path / "log.txt").write_text("")
    with pytest.raises(ConfigError, match=r"import a \.csv or \.mcap"):
        imported(store, tmp_path / "log.txt", MAP, "log.txt")


def mcap_file(path):
    """The run as messages of ROS 2 and of JSON under names of a laboratory's own."""
    rows, buffer = flown(), io.BytesIO()
    writer = Writer(buffer)
    writer.start()
    kind = "sensor_msgs/msg/JointState"
    schema = ros_schema(kind)
    joints = writer.register_channel(
        "/arm", "cdr", writer.register_schema(schema.name, schema.encoding, schema.data), {}
    )
    plain = writer.register_schema("any", "jsonschema", b"{}")
    bodies, commands = (writer.register_channel(topic, "json", plain, {}) for topic in ("/mocap", "/cmd"))
    names = ["l1", "l2", "l3", "r1", "r2", "r3"]
    for row in rows:
        at = 10**18 + round(1e9 * float(row["time"]))
        stamp = header("", at // 10**9, at % 10**9)
        message = ros(kind, stamp, names, row["joint_angle"].ravel(), np.empty(0), np.empty(0))
        writer.add_message(joints, at, serialized(message, kind), at)
        writer.add_message(
            commands, at, json.dumps({"rate": row["commanded_joint_rate"].ravel().tolist()}).encode(), at
        )
        half = [
            {"z": float(np.sin(row[f][2] / 2)), "w": float(np.cos(row[f][2] / 2))} for f in ("base_pose", "target_pose")
        ]
        content = {"base": [*row["base_pose"][:2]], "target": [*row["target_pose"][:2]], "turn": half}
        writer.add_message(bodies, at, json.dumps(content).encode(), at)
    writer.finish()
    path.write_bytes(buffer.getvalue())
    return path


MCAP_MAP = """
[joint_angle]
left = ["/arm:position[l1]", "/arm:position[l2]", "/arm:position[l3]"]
right = ["/arm:position[r1]", "/arm:position[r2]", "/arm:position[r3]"]
[commanded_joint_rate]
left = ["/cmd:rate[0]", "/cmd:rate[1]", "/cmd:rate[2]"]
right = ["/cmd:rate[3]", "/cmd:rate[4]", "/cmd:rate[5]"]
[base_pose]
x = "/mocap:base[0]"
y = "/mocap:base[1]"
quaternion = "/mocap:turn[0]"
[target_pose]
x = "/mocap:target[0]"
y = "/mocap:target[1]"
quaternion = "/mocap:turn[1]"
"""


def test_an_mcap_of_ros_and_json_becomes_a_run(store, tmp_path):
    done = imported(store, mcap_file(tmp_path / "bag.mcap"), MCAP_MAP, "bag.mcap")
    rows, true = rows_of(store, done), flown()
    assert rows["joint_angle"] == pytest.approx(true["joint_angle"], abs=1e-7)
    assert rows["target_pose"] == pytest.approx(true["target_pose"], abs=1e-7)
    assert rows["commanded_joint_rate"] == pytest.approx(true["commanded_joint_rate"], abs=1e-12)
    for wrong, words in (("/arm:", "/arms:"), ("[l1]", "[left]"), (":position", ":positions"), ("/cmd:", "cmd/")):
        with pytest.raises(ConfigError, match=r"bag\.mcap|TOPIC:PATH"):
            imported(store, tmp_path / "bag.mcap", MCAP_MAP.replace(wrong, words), "bag.mcap")
    (tmp_path / "cut.mcap").write_bytes((tmp_path / "bag.mcap").read_bytes()[:5000])
    with pytest.raises(ConfigError, match=r"cut\.mcap"):
        imported(store, tmp_path / "cut.mcap", MCAP_MAP, "cut.mcap")


def test_a_map_says_all_that_it_lacks():
    with pytest.raises(ConfigError, match="base_pose: Field required"):
        log_map('[joint_angle]\nleft = ["a", "b"]\nright = ["a", "b", "c"]')
