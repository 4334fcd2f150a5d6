"""A log in which nothing is wrong."""

import pytest
from monitor_logs import columns, make_log, write_parquet


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    return write_parquet(tmp_path_factory.mktemp("good") / "good.parquet", columns(make_log(48.0)))
