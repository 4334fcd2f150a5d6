"""Messages about the configuration name the file that holds the key."""

import pytest

from jointwear.files.errors import InputError
from jointwear.running import told_of
from jointwear.running.script import message_of
from jointwear.running.told_of import lend_sources, named_in_file


@pytest.fixture
def files(tmp_path):
    first, second = tmp_path / "first.yaml", tmp_path / "second.yaml"
    first.write_text("monitor:\n  robots:\n    arm: {window: 1x, events: [{time: 3}]}\nseed: 1\n")
    second.write_text("monitor:\n  stale_after: 1h\n  notify: [{name: shop, robots: [x]}]\nseed: 2\n")
    return [first, second]


@pytest.mark.parametrize(
    ("key", "place"),
    [
        ("monitor.robots.arm.window", 0),
        ("monitor.robots.arm.events[0].time", 0),
        ("monitor.stale_after", 1),
        ("seed", 1),
        ("monitor.notify: shop.robots", 1),
        ("monitor.robots.arm.logs", 0),
    ],
)
def test_the_last_file_that_holds_the_key_is_named(files, key, place):
    assert named_in_file(f"config: '{key}' is wrong", files) == f"{files[place]}: '{key}' is wrong"
    assert named_in_file(f"config: unknown key '{key}'", files) == f"{files[place]}: unknown key '{key}'"


def test_a_value_of_the_command_line_is_told_as_one(files):
    assert named_in_file("config: 'seed' is wrong", files, {"seed": "abc"}) == "--config: 'seed' is wrong"


def test_what_no_file_holds_is_told_as_before(files, tmp_path):
    for message in ("config: 'discover.datasets.arm.train' is wrong", "no.nc: no such file", "config: empty"):
        assert named_in_file(message, [*files, tmp_path / "none.yaml"]) == message


def test_a_job_names_the_file_that_the_key_came_from(files, monkeypatch):
    """What jobs found was said of `config`, what the call found before them of the file."""
    monkeypatch.setenv(told_of.SOURCES, "")
    error = InputError("config: 'monitor.robots.arm.baseline' holds too little")
    assert message_of(error) == f"jointwear: {error}"
    lend_sources(files, {"crate": "old.zip", "trust": {"whom": "secret"}})
    assert message_of(error) == f"jointwear: {files[0]}: 'monitor.robots.arm.baseline' holds too little"
    assert message_of(InputError("config: 'crate' is old.zip")) == "jointwear: --config: 'crate' is old.zip"
    assert "secret" not in told_of.os.environ[told_of.SOURCES]
