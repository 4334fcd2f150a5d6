"""A survey is kept for each way of reading the logs, so that a change that is undone finds its own again."""

import pytest
from monitor_logs import ROBOT, columns, make_log, write_parquet

from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json
from jointwear.monitor.reading import reading_stages
from jointwear.monitor.reading.kept_surveys import FILE, MOST, surveyed_log
from jointwear.monitor.reading.reading_stages import survey_first_log
from jointwear.monitor.reading.survey import read_survey

pytestmark = pytest.mark.usefixtures("surveyed_once")
ENTRY = {"window": "12s"}


@pytest.fixture
def surveyed(tmp_path):
    """Two logs, of which the first was surveyed; returns them and the file of the survey."""
    logs = [str(write_parquet(tmp_path / f"day_{k}.parquet", columns(make_log(24.0, seed=k)))) for k in (1, 2)]
    survey = tmp_path / "survey.json"
    survey_first_log(logs[0], ROBOT, ENTRY, survey)
    return logs, survey


def test_the_survey_of_a_log_that_is_gone_comes_back(surveyed, tmp_path):
    logs, survey = surveyed
    first = read_json(survey)
    (tmp_path / "day_1.parquet").unlink()
    there, other = logs[1:], ENTRY | {"scale": 1.5}
    assert surveyed_log(survey, there, ROBOT, other) == logs[1]
    survey_first_log(logs[1], ROBOT, other, survey)
    assert read_json(survey)["torque_reference"] != first["torque_reference"]
    survey.unlink()  # as Snakemake does before it runs the rule
    assert surveyed_log(survey, there, ROBOT, {"window": "0.2min"}) == logs[0]
    survey_first_log(logs[0], ROBOT, ENTRY, survey)
    assert read_json(survey) == first


def test_a_log_that_is_there_is_surveyed_anew(surveyed, tmp_path):
    logs, survey = surveyed
    first = read_json(survey)
    write_parquet(tmp_path / "day_1.parquet", columns(make_log(24.0, seed=5)))
    survey_first_log(logs[0], ROBOT, ENTRY, survey)
    assert read_json(survey) != first


@pytest.mark.parametrize("content", ["", "[]", '{"surveys": 5}', '{"surveys": {"a": {}}}'])
def test_kept_surveys_that_are_damaged_count_as_none(surveyed, tmp_path, content):
    logs, survey = surveyed
    (tmp_path / FILE).write_text(content)
    assert surveyed_log(survey, logs[::-1], ROBOT, ENTRY) == logs[0]
    survey.unlink()
    assert surveyed_log(survey, logs[1:], ROBOT, ENTRY) == logs[1]
    with pytest.raises(InputError, match="no such file"):
        survey_first_log(str(tmp_path / "gone.parquet"), ROBOT, ENTRY, survey)


def test_the_latest_surveys_are_kept(surveyed, tmp_path, monkeypatch):
    logs, survey = surveyed
    found = read_survey(survey)
    monkeypatch.setattr(reading_stages, "survey_log", lambda *_: found)
    for k in range(MOST):
        survey_first_log(logs[0], ROBOT, ENTRY | {"window": f"{13 + k}s"}, survey)
    assert len(read_json(tmp_path / FILE)["surveys"]) == MOST
    (tmp_path / "day_1.parquet").unlink()
    assert surveyed_log(survey, [logs[1]], ROBOT, ENTRY | {"window": "13s"}) == logs[0]
