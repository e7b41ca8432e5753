"""What parameters are called on a form: of what each is, where its name alone does not say so."""

from __future__ import annotations

_GROUPS = {
    "robot.base": ("Robot base", "{} of the base"),
    "robot.arm": ("Arms", "{}"),
    "robot.arm.link_1": ("Arms, link 1", "{} of link 1"),
    "robot.arm.link_2": ("Arms, link 2", "{} of link 2"),
    "robot.arm.link_3": ("Arms, link 3", "{} of link 3"),
    "robot.arm.hand": ("Hands", "{} of the hand"),
    "robot.servo": ("Joint servos", "{}"),
    "target": ("Target", "{} of the target"),
    "contact": ("Contact of tip and target", "{} of the contact"),
    "table": ("Air table", "{} of the table"),
    "": ("Mission", "{}"),
    "perception": ("Perception", "{}"),
    "perception.noise": ("Sensor noise", "Noise of the {}"),
    "perception.imperfections": ("Sensor imperfections", "{}"),
    "perception.wrist.left": ("Left wrist", "Left wrist: {}"),
    "perception.wrist.right": ("Right wrist", "Right wrist: {}"),
    "perception.capture": ("Motion capture", "Motion capture: {}"),
    "perception.filter": ("Filter of motion capture", "Expected {}"),
    "control": ("Controller", "{}"),
    "published.impedance": ("Impedance of the hands", "Virtual {} of the hand"),
    "published.touch": ("Touching", "{}"),
    "published.caging": ("Caging", "{}"),
    "control.tracking": ("Tracking of the path", "{} gain"),
    "control.rates": ("Joint rates", "{}"),
    "judging": ("Judging the outcome", "{}"),
    "simulation": ("Simulation", "{}"),
}
"""Heading of each group, and how a name in it is completed."""

_METHODS = {"co_moving_couple": "Co-moving couple"}
"""What a method is called in the headings of its groups, where its name does not say it."""

_WHOLE = frozenset(
    {
        "robot.base.centre_of_mass_ahead",
        "target.initial_x",
        "target.initial_y",
        "target.initial_angle",
        "target.initial_velocity_x",
        "target.initial_velocity_y",
        "target.initial_spin",
        "contact.friction_speed",
        "contact.corner",
        "robot.arm.hand.centre_offset",
        "robot.arm.hand.tip_offset",
        "robot.arm.hand.tip_radius",
        "robot.arm.hand.finger_radius",
    }
)
"""Names that say of what they are."""


def group_title(group: str) -> str:
    """The heading of a group of parameters; its own words if this table does not know it."""
    if group in _GROUPS:
        return _GROUPS[group][0]
    return _first_upper(" · ".join(_METHODS.get(part, _words(part)) for part in group.split(".")))


def parameter_title(path: str) -> str:
    """What the parameter at that full path is, in a few words: "Virtual mass of the hand"."""
    group, _, name = path.rpartition(".")
    words = _words(name)
    pattern = "{}" if path in _WHOLE else _GROUPS.get(group, ("", "{}"))[1]
    return _first_upper(pattern.format(words))


def _words(name: str) -> str:
    return name.replace("_", " ")


def _first_upper(text: str) -> str:
    return text[:1].upper() + text[1:]
