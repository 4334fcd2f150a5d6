"""The verdicts of the report that are kept with the project, so that its first page tells no others."""

from __future__ import annotations

from pathlib import Path

from jointwear.files.json_documents import read_json, write_json


def write_stored(scores: str | Path, output: str | Path) -> None:
    """Write the verdicts on the paper and the scores of its tables, with the digest of the configuration behind them.

    Parameters
    ----------
    scores : `summary.json` of a report. output : JSON with `config_digest`, `totals` of the verdicts, `verdicts` by key
        of the statement, and `scores` by table.

    Raises
    ------
    InputError : if the scores are missing or damaged.
    """
    content = read_json(scores)
    summary = content["summary"]
    write_json(
        output,
        {
            "config_digest": content["config_digest"],
            "totals": summary["totals"],
            "verdicts": {statement["key"]: statement["verdict"] for statement in summary["statements"]},
            "scores": content["scores"],
        },
    )
