"""Every number that a person may choose: unit, bounds, source; what is refused and how it is said."""

from __future__ import annotations

import enum
import math
from typing import Any, cast

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sim.config import PARAMETERS, MissionConfig, TargetShape, differences, is_live, value_at
from sim.configurations import NAMED_CONFIGURATIONS, nested, revised
from sim.errors import ConfigError
from sim.model.inertia import outlines
from sim.parameters import Points

UNITS = {
    "m",
    "s",
    "kg",
    "kg m2",
    "N",
    "N m",
    "N/m",
    "N s/m",
    "rad",
    "rad/s",
    "m/s",
    "m2",
    "1",
    "1/s",
    "1/s2",
    "s/N",
    "s/rad",
    "Hz",
    "m/s2",
    "rad/s2",
}
BOUNDS = ("ge", "gt", "le", "lt")
NUMBERS = [path for path, field in PARAMETERS.items() if field.annotation in (float, int)]
POINTS = [path for path, field in PARAMETERS.items() if field.annotation == Points]
CHOICES = [path for path in PARAMETERS if path not in (*NUMBERS, *POINTS)]
OUT_OF_HARMS_WAY = {
    "target.initial_x",
    "target.initial_y",
    *(path for body in outlines(MissionConfig()) for path in body.parameters),
}
"""Not varied at random: a target may then overlap the robot, or a body be none that there can be; with reasons."""


def bounds_of(path: str) -> dict[str, float]:
    return {name: getattr(part, name) for part in PARAMETERS[path].metadata for name in BOUNDS if hasattr(part, name)}


class TestEveryParameter:
    @pytest.mark.parametrize("path", PARAMETERS)
    def test_has_unit_source_and_description(self, path):
        field = PARAMETERS[path]
        assert field.json_schema_extra["unit"] in UNITS
        assert len(field.json_schema_extra["source"]) > 4
        assert len(field.description) > 1
        assert isinstance(field.json_schema_extra["live"], bool)

    @pytest.mark.parametrize("path", NUMBERS)
    def test_number_has_a_lower_and_an_upper_bound_that_hold_its_default(self, path):
        bounds = bounds_of(path)
        assert bounds.keys() & {"ge", "gt"}, "no lower bound"
        assert bounds.keys() & {"le", "lt"}, "no upper bound"
        value = value_at(MissionConfig(), path)
        assert bounds.get("ge", -math.inf) <= value <= bounds.get("le", math.inf)
        assert bounds.get("gt", -math.inf) < value < bounds.get("lt", math.inf)

    @pytest.mark.parametrize("path", CHOICES)
    def test_choice_is_an_enumeration(self, path):
        assert issubclass(PARAMETERS[path].annotation, enum.StrEnum)

    def test_a_default_that_is_chosen_says_why(self):
        for path, field in PARAMETERS.items():
            source = field.json_schema_extra["source"]
            if source.startswith("chosen") and path != "simulation.seed":
                assert source.startswith("chosen: "), path

    def test_geometry_and_numerics_are_not_live_and_the_impedance_is(self):
        live = {path for path in PARAMETERS if is_live(path)}
        assert {f"published.impedance.{name}" for name in ("mass", "damping", "stiffness")} <= live
        assert not [path for path in live if path.startswith(("robot.", "target.", "simulation.", "contact."))]


class TestRefusal:
    """A bad value is named with field, value, bound and unit."""

    @pytest.mark.parametrize("path", NUMBERS)
    @pytest.mark.parametrize("side", ["below", "above"])
    def test_of_a_value_beyond_its_bound(self, path, side):
        bounds = bounds_of(path)
        names = ("ge", "gt") if side == "below" else ("le", "lt")
        bound = next(bounds[name] for name in names if name in bounds)
        step = 1 if PARAMETERS[path].annotation is int else max(1e-3, 1e-3 * abs(bound))
        value = bound - step if side == "below" else bound + step
        with pytest.raises(ConfigError) as refusal:
            revised(MissionConfig(), nested({path: value}))
        message = str(refusal.value)
        assert f"{path} = " in message
        assert repr(value) in message or f"{value:g}" in message
        assert any(sign in message for sign in ("greater than", "less than"))
        unit = PARAMETERS[path].json_schema_extra["unit"]
        assert unit == "1" or f"[{unit}]" in message

    @pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
    @pytest.mark.parametrize("path", ["target.mass", "published.impedance.damping", "target.initial_x"])
    def test_of_what_is_not_a_finite_number(self, path, value):
        with pytest.raises(ConfigError, match=path):
            revised(MissionConfig(), nested({path: value}))

    @pytest.mark.parametrize("value", ["heavy", None, [1.0], {"a": 1}, True])
    def test_of_what_is_not_a_number(self, value):
        with pytest.raises(ConfigError, match=r"target\.mass"):
            revised(MissionConfig(), nested({"target.mass": value}))

    @pytest.mark.parametrize("value", [1.5, "7"])
    def test_of_what_is_not_a_whole_number(self, value):
        with pytest.raises(ConfigError, match=r"simulation\.seed"):
            revised(MissionConfig(), nested({"simulation.seed": value}))

    def test_of_an_unknown_field_names_the_nearest(self):
        with pytest.raises(ConfigError, match=r"impedance\.dampign.*did you mean published\.impedance\.damping"):
            revised(MissionConfig(), nested({"published.impedance.dampign": 3.0}))

    def test_of_an_unknown_choice_names_those_there_are(self):
        with pytest.raises(ConfigError, match=r"contact\.corner = 'round'.*face.*radial"):
            revised(MissionConfig(), nested({"contact.corner": "round"}))

    @pytest.mark.parametrize(
        "changes", [{"inertia": 0.0265}, {"side": 0.08}, {"mass": 0.8}, {"inertia": 1.0, "mass": 5.0}]
    )
    def test_of_a_target_whose_inertia_no_body_of_its_size_can_have(self, changes):
        with pytest.raises(
            ConfigError, match=r"target\.inertia = .* at most .* kg m2, with all of its mass as far out as it reaches"
        ):
            revised(MissionConfig(), {"target": changes})

    @pytest.mark.parametrize("changes", [{"inertia": 0.0264}, {"inertia": 1e-4}, {"side": 0.1}, {"mass": 0.9}])
    def test_of_no_target_that_there_can_be(self, changes):
        assert revised(MissionConfig(), {"target": changes}).target

    @pytest.mark.parametrize("shape", [shape for shape in TargetShape if shape is not TargetShape.SQUARE])
    def test_of_a_target_that_the_method_cannot_capture(self, shape):
        with pytest.raises(ConfigError, match=rf"target\.shape = {shape}: method = published .* square") as refusal:
            revised(MissionConfig(), {"target": {"shape": shape.value}})
        assert "target.shape = square" in refusal.value.tip

    @pytest.mark.parametrize("shape", ["square", "polygon"])
    @pytest.mark.parametrize(
        ("vertices", "words"),
        [
            ([[0, 0], [0.1, 0]], r"target\.vertices = \[\[0, 0\], \[0\.1, 0\]\]: .* at least 3 items"),
            ([[0, 0]] * 13, r"target\.vertices = .* at most 12 items"),
            ([[0, 0], [0, 0.1], [0.1, 0]], r"target\.vertices = '0, 0; 0, 0\.1; 0\.1, 0': .* clockwise"),
            ([[0, 0], [0.1, 0], [0.1, 0], [0, 0.1]], "vertices 2 and 3 are the same point"),
            ([[0, 0], [0.1, 0], [0.2, 0], [0, 0.1]], r"vertex 2 \(0\.1, 0\) lies on the line between its neighbours"),
            ([[0, 0], [0.1, 0], [0.02, 0.02], [0, 0.1]], r"at vertex 3 \(0\.02, 0\.02\) the outline turns right"),
            ([[0, 0], [4, 0], [0, 4]], r"farthest corner is 2\.981 m from the centroid; it must be at most 2 m"),
            ([[0, 0], [0.1, 0], [0, 0.001]], r"nearest side is 0\.0003333 m .* at least 0\.001 m"),
            ([[0, 0], [11, 0], [0, 0.1]], r"target\.vertices\.1\.0 = 11: .* less than or equal to 10 \[m\]$"),
            ([[0, 0], [True, 0], [0, 0.1]], r"target\.vertices\.1\.0 = True: .* valid number \[m\]$"),
            ([[0, 0, 0], [0.1, 0], [0, 0.1]], r"target\.vertices\.0 = \[0, 0, 0\]: .* at most 2 items .*not 3$"),
            ("a wedge", r"target\.vertices = 'a wedge': .* array"),
        ],
        ids=lambda value: None if isinstance(value, str) else "",
    )
    def test_of_vertices_that_are_no_convex_polygon_of_its_kind(self, vertices, words, shape):
        with pytest.raises(ConfigError, match=words):
            revised(MissionConfig(), {"method": "published", "target": {"vertices": vertices, "shape": shape}})

    @pytest.mark.parametrize("body", outlines(MissionConfig()), ids=lambda body: body.group)
    def test_of_an_inertia_that_no_body_of_its_size_can_have(self, body):
        above, below = (nested({f"{body.group}.inertia": part * body.most}) for part in (1.001, 0.999))
        with pytest.raises(ConfigError, match=rf"{body.group}\.inertia = .* at most .* kg m2") as refusal:
            revised(MissionConfig(), above)
        assert "even plate" in refusal.value.tip
        assert revised(MissionConfig(), below)

    @pytest.mark.parametrize(
        ("changes", "named"),
        [
            ({"robot.base.centre_of_mass_ahead": 0.0801}, "robot.base.centre_of_mass_ahead"),
            ({"robot.base.centre_of_mass_ahead": -0.0801}, "robot.base.centre_of_mass_ahead"),
            ({"robot.arm.link_2.centre_of_mass": 0.196}, "robot.arm.link_2.centre_of_mass"),
            ({"robot.arm.link_1.length": 0.2, "robot.arm.link_1.centre_of_mass": 0.22}, "link_1.centre_of_mass"),
            ({"robot.arm.hand.centre_of_mass": 0.06}, "robot.arm.hand.centre_of_mass"),
        ],
    )
    def test_of_a_centre_of_mass_outside_of_its_body(self, changes, named):
        with pytest.raises(ConfigError, match=rf"{named} = .* lies within it") as refusal:
            revised(MissionConfig(), nested(changes))
        assert "it can be from" in refusal.value.tip

    def test_of_no_other_change_to_a_stored_configuration_that_has_one(self):
        stored = MissionConfig.model_validate({"target": {"inertia": 1.0}})
        assert revised(stored, {"published": {"impedance": {"damping": 3.0}}}).target.inertia == 1.0

    def test_of_several_at_once_names_each(self):
        with pytest.raises(ConfigError) as refusal:
            revised(MissionConfig(), nested({"target.mass": -1.0, "published.impedance.mass": 0.0}))
        assert "target.mass = -1.0" in str(refusal.value)
        assert "published.impedance.mass = 0.0" in str(refusal.value)

    @pytest.mark.parametrize("step", [0.3e-3, 0.7e-3, 2e-3])
    def test_of_a_step_that_does_not_divide_the_control_period(self, step):
        with pytest.raises(ConfigError, match=rf"simulation\.time_step = {step:g} s does not divide control\.period"):
            revised(MissionConfig(), nested({"simulation.time_step": step}))

    @pytest.mark.parametrize("parts", [1, 2, 3, 4, 7, 10])
    def test_whole_fractions_of_the_period_are_accepted(self, parts):
        assert revised(MissionConfig(), nested({"simulation.time_step": 1e-3 / parts}))

    def test_of_a_target_that_overlaps_the_robot(self):
        with pytest.raises(
            ConfigError, match=r"target\.initial_y = 0\.1 m: the target overlaps the robot's base by .* mm"
        ) as refusal:
            revised(MissionConfig(), nested({"target.initial_y": 0.1}))
        assert refusal.value.tip

    def test_of_a_change_to_what_is_frozen(self):
        with pytest.raises(ValidationError, match="frozen"):
            MissionConfig().target.mass = 3.0  # type: ignore[misc]


numbers = st.sampled_from(
    [
        path
        for path in NUMBERS
        if path not in OUT_OF_HARMS_WAY
        and not path.startswith(("robot.base", "robot.arm", "simulation.time_step", "control.period"))
        and not path.startswith("target.centre_of_mass_")  # it lies within the outline
        and not path.endswith(("touch.force_floor", "touch.force_cap", "touch.planned_cap"))  # the caps are over it
    ]
)


@st.composite
def good_changes(draw):
    """A few parameters, each at some value within its bounds."""
    changes: dict[str, Any] = {}
    for path in draw(st.lists(numbers, max_size=4, unique=True)):
        bounds = bounds_of(path)
        low, high = cast(tuple[float, float], (bounds.get("ge", bounds.get("gt")), bounds.get("le", bounds.get("lt"))))
        if PARAMETERS[path].annotation is int:
            changes[path] = draw(st.integers(int(low), int(high)))
        else:
            changes[path] = draw(st.floats(low, high, exclude_min="gt" in bounds, exclude_max="lt" in bounds))
    return changes


class TestProperties:
    @settings(deadline=None, max_examples=60)
    @given(good_changes())
    def test_what_is_within_bounds_is_taken_and_told_as_a_difference(self, changes):
        config = revised(MissionConfig(), nested(changes))
        for path, value in changes.items():
            assert value_at(config, path) == value
        different = {path for path, value in changes.items() if value != value_at(MissionConfig(), path)}
        assert set(differences(MissionConfig(), config)) == different

    @settings(deadline=None, max_examples=60)
    @given(good_changes())
    def test_json_there_and_back_changes_nothing(self, changes):
        config = revised(MissionConfig(), nested(changes))
        assert MissionConfig.model_validate_json(config.model_dump_json()) == config

    @settings(deadline=None, max_examples=60)
    @given(good_changes())
    def test_a_revision_without_changes_is_the_same(self, changes):
        config = revised(MissionConfig(), nested(changes))
        assert revised(config, {}) == config
        assert revised(revised(config, nested(changes)), {}) == config

    @settings(deadline=None, max_examples=60)
    @given(good_changes())
    def test_a_difference_undone_is_gone(self, changes):
        config = revised(MissionConfig(), nested(changes))
        back = {path: old for path, (old, _) in differences(MissionConfig(), config).items()}
        assert revised(config, nested(back)) == MissionConfig()


@pytest.mark.parametrize("name", list(NAMED_CONFIGURATIONS))
def test_named_configurations_survive_json(name):
    config = NAMED_CONFIGURATIONS[name]
    assert MissionConfig.model_validate_json(config.model_dump_json()) == config
    assert revised(config, {}) == config
