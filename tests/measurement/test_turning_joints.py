"""A joint that turns on and on lies beyond its limits and is in rad; degrees are told beside it."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_logs import LENGTH, columns, layout, make_log, model, write_parquet

from jointwear.measurement.checks.checked import checked
from jointwear.measurement.recording import split
from jointwear.measurement.recording_files import load_recording
from jointwear.measurement.refused import Refused
from jointwear.monitor.reading.logs import log_statistics
from jointwear.monitor.reading.model import TorqueModel
from jointwear.monitor.reading.survey import survey_log
from jointwear.robots.robot import load_robot

#: Two turns of the last joint [rad].
ON = 4 * np.pi * (np.arange(6) == 5)
#: What to do with degrees, and with angles of the motors, which the limits alone do not tell from them.
DEGREES = "state units: {position: deg}"
MOTORS = (
    "; where they are angles of the motors, divide those of each joint by its gear_ratio, and give the gear_ratios as "
    "'scale' where the torques are of the motors too"
)


def turning(robot, joints):
    """The robot with joints that have no limits, as the readers of robot files write these."""
    free = np.isin(np.arange(robot.joints), joints)
    turn = 2 * np.pi
    return replace(robot, lower=np.where(free, -turn, robot.lower), upper=np.where(free, turn, robot.upper))


@pytest.mark.long
@pytest.mark.parametrize("joints", [[5], range(6)])
def test_two_turns_are_no_degrees(joints):
    robot = turning(load_robot("config/robots/puma560.yaml"), joints)
    recording = split(load_recording({"measured": "data/examples/puma560_hidden.nc"}, "arm"))
    on = replace(recording, position=recording.position + ON)
    assert checked(on, robot).restrictions == checked(recording, robot).restrictions
    # Two turns in degrees are more than the motor of that joint would turn within its reach.
    for wrong, said in ((recording, DEGREES + MOTORS), (on, DEGREES)):
        with pytest.raises(Refused, match="look like degrees") as refused:
            checked(replace(wrong, position=np.degrees(wrong.position)), robot)
        assert refused.value.suggestion == said


def test_a_log_of_a_joint_that_turned_twice_is_judged(tmp_path):
    reading = layout(), TorqueModel(turning(model().robot, [5]))
    log = make_log(48.0)
    path = str(write_parquet(tmp_path / "log.parquet", columns(replace(log, position=log.position + ON))))
    found = log_statistics(path, *reading, survey_log(path, *reading, LENGTH), LENGTH)
    assert found.refused == ()
    assert found.statistics.judgeable[:, :5].all()
