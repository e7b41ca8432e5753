"""The same robot in MuJoCo, an independent rigid-body library, built from the same configuration.

MuJoCo counts freedoms along the tree (base x, y, angle, then joints 1-3 and mount of the left arm, then of
the right); `SIM_ORDER` brings them into the order of `sim.model.robot`.
"""

from __future__ import annotations

import mujoco
import numpy as np

from sim.config import LinkConfig, RobotConfig

SIM_ORDER = [0, 1, 2, 3, 4, 5, 7, 8, 9, 6, 10]


class Reference:
    """Mass matrix, hand Jacobians and momentum of the robot, as MuJoCo sees them."""

    def __init__(self, config: RobotConfig) -> None:
        self.model = mujoco.MjModel.from_xml_string(_robot_xml(config))
        self.data = mujoco.MjData(self.model)

    def place(self, base_pose, joint_angle, mount_angle, velocity) -> None:
        """Put the robot into a configuration and motion; velocity in the order of `sim`, shape (11,)."""
        freedoms = np.concatenate([base_pose, joint_angle.ravel(), mount_angle])
        self.data.qpos[SIM_ORDER] = freedoms
        self.data.qvel[SIM_ORDER] = velocity
        mujoco.mj_forward(self.model, self.data)
        mujoco.mj_subtreeVel(self.model, self.data)

    def inertia(self):
        full = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, full)
        return full[np.ix_(SIM_ORDER, SIM_ORDER)]

    def hand_jacobian(self):
        rows = []
        for name in ("left_hand", "right_hand"):
            linear, angular = np.zeros((3, self.model.nv)), np.zeros((3, self.model.nv))
            mujoco.mj_jacSite(self.model, self.data, linear, angular, self.data.site(name).id)
            rows += [linear[0], linear[1], angular[2]]
        return np.array(rows)[:, SIM_ORDER]

    def hand_pose(self):
        poses = []
        for name in ("left_hand", "right_hand"):
            site = self.data.site(name)
            turn = site.xmat.reshape(3, 3)
            poses.append([site.xpos[0], site.xpos[1], np.arctan2(turn[1, 0], turn[0, 0])])
        return np.array(poses)

    def momentum_about_base(self):
        """Linear, and angular about the base's centre of mass, shape (3,)."""
        base = self.data.body("base")
        linear = self.model.body("base").subtreemass[0] * base.subtree_linvel
        about_base = base.subtree_angmom + np.cross(base.subtree_com - base.xpos, linear)
        return np.array([linear[0], linear[1], about_base[2]])


def _inertial(mass: float, centre: float, inertia: float) -> str:
    # In the plane only the moment about z counts; equal moments about x and y satisfy the triangle inequality.
    return f'<inertial pos="0 {centre!r} 0" mass="{mass!r}" diaginertia="{inertia!r} {inertia!r} {inertia!r}"/>'


def _robot_xml(config: RobotConfig) -> str:
    base = config.base
    ahead = base.depth / 2 - base.centre_of_mass_ahead
    arms = "".join(
        _arm_xml(config, name, f"{side * base.width / 2!r} {ahead!r} 0") for name, side in (("left", -1), ("right", 1))
    )
    return f"""
<mujoco>
  <compiler angle="radian"/>
  <option gravity="0 0 0"/>
  <worldbody>
    <body name="base">
      <joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 1 0"/>
      <joint type="hinge" axis="0 0 1"/>
      {_inertial(base.mass, 0.0, base.inertia)}
      {arms}
    </body>
  </worldbody>
</mujoco>"""


def _arm_xml(config: RobotConfig, name: str, shoulder: str) -> str:
    arm, hand = config.arm, config.arm.hand
    palm = LinkConfig(
        length=hand.centre_offset, mass=hand.mass, inertia=hand.inertia, centre_of_mass=hand.centre_of_mass
    )
    inner = f'<site name="{name}_hand" pos="0 {hand.centre_offset!r} 0"/>'
    links = [arm.link_1, arm.link_2, arm.link_3, palm]
    for place in reversed(range(len(links))):
        link = links[place]
        at = shoulder if place == 0 else f"0 {links[place - 1].length!r} 0"
        inner = (
            f'<body pos="{at}"><joint type="hinge" axis="0 0 1"/>'
            f"{_inertial(link.mass, link.centre_of_mass, link.inertia)}{inner}</body>"
        )
    return inner
