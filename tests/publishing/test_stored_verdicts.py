"""What is kept of a report with the project."""

import pytest

from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json, write_json
from jointwear.publishing.report.stored import write_stored


def test_verdicts_and_scores_are_kept_with_the_digest_of_their_configuration(tmp_path):
    scores = {"table_iv": {"verdicts": {"agrees": 13}}}
    statements = [{"key": "table_iv", "title": "Hours", "verdict": "differs", "text": "13 agree."}]
    report = {
        "summary": {"totals": {"agrees": 13}, "statements": statements, "claims": []},
        "scores": scores,
        "config_digest": "12ab",
        "source": {"version": "0.1.0"},
    }
    write_json(tmp_path / "summary.json", report)
    write_stored(tmp_path / "summary.json", tmp_path / "stored.json")
    assert read_json(tmp_path / "stored.json") == {
        "config_digest": "12ab",
        "totals": {"agrees": 13},
        "verdicts": {"table_iv": "differs"},
        "scores": scores,
    }


def test_a_damaged_report_leaves_what_was_kept(tmp_path):
    (tmp_path / "summary.json").write_text("{")
    (tmp_path / "stored.json").write_text("kept")
    with pytest.raises(InputError, match=r"summary\.json"):
        write_stored(tmp_path / "summary.json", tmp_path / "stored.json")
    assert (tmp_path / "stored.json").read_text() == "kept"
