"""The robot model against torques, inertias and positions of the original MATLAB toolbox."""

import numpy as np
import pytest

from jointwear.robots.robot import load_robot
from jointwear.robots.trajectory import quintic

TOLERANCE = 1e-10


def states(oracle, name="states"):
    data = oracle(name)
    return data, [data.by_joint(c) for c in ("q_rad", "qd_rad_s", "qdd_rad_s2")]


def test_parameters_are_those_of_the_toolbox(oracle, puma):
    data = oracle("params")
    robot = puma.robot
    pairs = {
        "armature_G2Jm_kgm2": robot.armature,
        "viscous_G2B_Nms_per_rad": robot.viscous,
        "coulomb_pos_absG_Tc_Nm": robot.coulomb_positive,
        "coulomb_neg_absG_Tc_Nm": robot.coulomb_negative,
        "qlim_lo_rad": robot.lower,
        "qlim_hi_rad": robot.upper,
    }
    for column, value in pairs.items():
        np.testing.assert_allclose(value, data.column(column), atol=TOLERANCE, err_msg=column)


@pytest.mark.parametrize("name", ["states", "edge_zero_velocity"])
def test_torque_with_and_without_friction(oracle, puma, name):
    data, motion = states(oracle, name)
    np.testing.assert_allclose(puma.rigid_body_torque(*motion), data.by_joint("tau_nofriction_Nm"), atol=TOLERANCE)
    np.testing.assert_allclose(puma.inverse_dynamics(*motion), data.by_joint("tau_friction_Nm"), atol=TOLERANCE)
    np.testing.assert_allclose(-puma.friction_torque(motion[1]), data.by_joint("friction_toolbox_Nm"), atol=TOLERANCE)


def test_viscous_friction_alone(oracle, puma):
    data, motion = states(oracle)
    still = np.zeros(6)
    torque = puma.inverse_dynamics(*motion, coulomb=(still, still))
    np.testing.assert_allclose(torque, data.by_joint("tau_viscous_only_Nm"), atol=TOLERANCE)


def test_threads_do_not_change_a_number(oracle, puma):
    _, motion = states(oracle)
    assert np.array_equal(puma.inverse_dynamics(*motion, threads=2), puma.inverse_dynamics(*motion))


def test_gravity(oracle, puma):
    data, (position, _, _) = states(oracle)
    np.testing.assert_allclose(puma.gravity_torque(position), data.by_joint("gravload_Nm"), atol=TOLERANCE)


def test_slopes_are_differences_of_the_torque(puma):
    random = np.random.default_rng(3)
    q, v, a = random.normal(size=(3, 4, 6))
    by_angle, by_velocity = puma.torque_slopes(q, v, a)
    for joint, step in enumerate(1e-5 * np.eye(6)):
        turned = (puma.rigid_body_torque(q + step, v, a) - puma.rigid_body_torque(q - step, v, a)) / 2e-5
        np.testing.assert_allclose(by_angle[:, :, joint], turned, atol=1e-6)
        faster = (puma.rigid_body_torque(q, v + step, a) - puma.rigid_body_torque(q, v - step, a)) / 2e-5
        np.testing.assert_allclose(by_velocity[:, :, joint], faster, atol=1e-6)


def test_mass_matrix(oracle, puma):
    _, (position, _, _) = states(oracle)
    expected = oracle("inertia").column("M_kgm2").reshape(-1, 6, 6)
    np.testing.assert_allclose(puma.mass_matrix(position), expected, atol=TOLERANCE)


def accelerations(dynamics, position, velocity, torque, coulomb=None):
    """Accelerations (m, n) [rad/s2] that torques (m, n) [N m] cause against friction and gravity."""
    bias = dynamics.inverse_dynamics(position, velocity, np.zeros_like(position), coulomb)
    return np.linalg.solve(dynamics.mass_matrix(position), (torque - bias)[..., None])[..., 0]


def test_accelerations(oracle, puma):
    data = oracle("accel")
    _, (position, velocity, _) = states(oracle)
    torque = data.by_joint("tau_applied_Nm")
    position, velocity = position[:50], velocity[:50]
    still = (np.zeros(6), np.zeros(6))
    np.testing.assert_allclose(
        accelerations(puma, position, velocity, torque), data.by_joint("qdd_friction_rad_s2"), atol=TOLERANCE
    )
    # Without any friction: take viscous friction out of the torque's way.
    free = torque + velocity * puma.robot.viscous
    np.testing.assert_allclose(
        accelerations(puma, position, velocity, free, still), data.by_joint("qdd_nofriction_rad_s2"), atol=TOLERANCE
    )


def test_kinematics(oracle, puma):
    data = oracle("fk")
    _, (position, _, _) = states(oracle)
    translation, rotation = puma.forward_kinematics(position[:50])
    for k, axis in enumerate("xyz"):
        np.testing.assert_allclose(translation[:, k], data.column(f"{axis}_m"), atol=TOLERANCE)
    for i in range(3):
        for j in range(3):
            np.testing.assert_allclose(rotation[:, i, j], data.column(f"r{i + 1}{j + 1}"), atol=TOLERANCE)


def test_jtraj(oracle, puma):
    pairs, data = oracle("jtraj_pairs"), oracle("jtraj")
    starts, stops = pairs.by_joint("q_start_rad"), pairs.by_joint("q_end_rad")
    time = data.by_joint("t_s")[:, 0].reshape(3, 121)
    for k in range(3):
        rows = slice(121 * k, 121 * (k + 1))
        motion = quintic(starts[k], stops[k], 60.0, time[k])
        np.testing.assert_allclose(motion.position, data.by_joint("q_rad")[rows], atol=TOLERANCE)
        np.testing.assert_allclose(motion.velocity, data.by_joint("qd_rad_s")[rows], atol=TOLERANCE)
        np.testing.assert_allclose(motion.acceleration, data.by_joint("qdd_rad_s2")[rows], atol=TOLERANCE)
        torque = puma.inverse_dynamics(motion.position, motion.velocity, motion.acceleration)
        # At 60 s the toolbox's velocity is round-off with an arbitrary sign, ours is exactly 0.
        np.testing.assert_allclose(torque[:-1], data.by_joint("tau_friction_Nm")[rows][:-1], atol=TOLERANCE)
        given = [data.by_joint(c)[rows] for c in ("q_rad", "qd_rad_s", "qdd_rad_s2")]
        expected = data.by_joint("tau_friction_Nm")[rows]
        np.testing.assert_allclose(puma.inverse_dynamics(*given), expected, atol=TOLERANCE)


def test_worn_friction(oracle, puma):
    data = oracle("wear")
    _, motion = states(oracle)
    expected = data.by_joint("tau_friction_Nm")
    worn, scale = data.by_joint("worn_joint")[:, 0].astype(int), data.by_joint("tc_scale")[:, 0]
    state = data.by_joint("state_id")[:, 0].astype(int)
    for row in range(len(expected)):
        factor = np.ones(6)
        factor[worn[row] - 1] = scale[row]
        coulomb = puma.robot.coulomb_positive * factor, puma.robot.coulomb_negative * factor
        torque = puma.inverse_dynamics(*(m[state[row]] for m in motion), coulomb=coulomb)
        np.testing.assert_allclose(torque, expected[row], atol=TOLERANCE)


def urdf_of(path, robot):
    """Write the DH arm `robot` as a URDF: every joint placed by the constant part of the row before."""
    import pinocchio as pin

    lines, parent, before = [f'<robot name="{robot.name}"><link name="base"/>'], "base", pin.SE3.Identity()
    for i, (row, link, name) in enumerate(zip(robot.dh, robot.links, robot.joint_names, strict=True)):
        frame = pin.SE3(np.eye(3), np.array([0, 0, row.d])) * pin.SE3(
            pin.utils.rotate("x", row.alpha), np.array([row.a, 0.0, 0.0])
        )
        x, y, z = before.translation
        roll, pitch, yaw = pin.rpy.matrixToRpy(before.rotation)
        com = frame.act(link.com)
        inertia = frame.rotation @ link.inertia @ frame.rotation.T
        lines.append(
            f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="link_{i}"/>'
            f'<origin xyz="{x!r} {y!r} {z!r}" rpy="{roll!r} {pitch!r} {yaw!r}"/><axis xyz="0 0 1"/>'
            f'<limit lower="{robot.lower[i]}" upper="{robot.upper[i]}" effort="0" velocity="1"/></joint>'
            f'<link name="link_{i}"><inertial><origin xyz="{com[0]} {com[1]} {com[2]}"/><mass value="{link.mass}"/>'
            f'<inertia ixx="{inertia[0, 0]}" iyy="{inertia[1, 1]}" izz="{inertia[2, 2]}" ixy="{inertia[0, 1]}" '
            f'iyz="{inertia[1, 2]}" ixz="{inertia[0, 2]}"/></inertial></link>'
        )
        parent, before = f"link_{i}", frame
    path.write_text("\n".join(lines).replace("np.float64(", "").replace(")", "") + "</robot>")


def test_a_urdf_gives_the_same_torque_as_the_dh_table(tmp_path, oracle, puma):
    from jointwear.robots.dynamics import Dynamics

    urdf_of(tmp_path / "puma.urdf", puma.robot)
    # The toolbox arm has inertia without mass in its first link.
    (tmp_path / "robot.yaml").write_text("name: puma_urdf\nurdf: puma.urdf\ninertia_check: none\n")
    arm = Dynamics(load_robot(tmp_path / "robot.yaml"))
    arm.model.armature = puma.model.armature
    _, motion = states(oracle)
    np.testing.assert_allclose(arm.rigid_body_torque(*motion), puma.rigid_body_torque(*motion), atol=1e-8)


def test_a_payload_changes_only_what_gravity_and_inertia_reach(root, oracle, puma):
    from jointwear.robots.dynamics import Dynamics

    loaded = Dynamics(load_robot(root / "config/robots/puma560_paper.yaml"))
    position = np.zeros(6)
    position[1] = np.pi / 2  # upper arm upwards
    difference = loaded.gravity_torque(position) - puma.gravity_torque(position)
    payload = loaded.robot.payload
    place, turn = puma.forward_kinematics(position)
    lever = place + turn @ payload.com
    assert difference[1] == pytest.approx(payload.mass * 9.81 * lever[0], abs=1e-9)
