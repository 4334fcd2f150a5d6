"""Messages: each alarm once and its end too, nothing lost to a service that is down, no secret in what is kept."""

import json
import socketserver
import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.files.errors import InputError
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.notify.channels import blot, without_address
from jointwear.monitor.notify.notices import Notice, closures, notices
from jointwear.monitor.notify.outbox import MOST_LINES, Outbox
from jointwear.monitor.notify.plan import check_channels
from jointwear.monitor.notify.stage import notify
from jointwear.running.configuration import prepare

SECRET = "Zk4-topsecret"
HOUR = 1_767_225_600.0


def episode(axis=3, active=True, detector="model", key="3|coulomb friction|model|"):
    return {
        "key": key, "axis": axis, "quantity": "coulomb friction", "detector": detector, "first": HOUR, "last": HOUR,
        "alarms": 2, "open": active, "change": 1.0, "change_low": 0.5, "change_high": 1.5, "unit": "N m",
    }  # fmt: skip


def axis_row(level="changed"):
    return {
        "axis": 3, "joint": "elbow", "level": level, "reached": False, "growth": 7.5, "growth_std": 0.5, "limit": 20.0,
        "hours": [100.0, 50.0, None],
        "limit_at": [HOUR + 360_000.0, HOUR + 180_000.0, None],
        "quantity": "coulomb friction", "change": 1.0, "unit": "N m", "since": HOUR,
        "alarms": 2, "check": "check the gear",
    }  # fmt: skip


def robot(*episodes, name="cell_3", **more):
    return {
        "robot": name, "folder": name, "result": "judged", "reason": "", "stale": False, "silence_hours": 1.0,
        "dated": True, "last_sample": HOUR, "refused_newest": 0, "refusals": [],
        "axes": [axis_row()], "episodes": list(episodes), **more,
    }  # fmt: skip


class Desk:
    """A fleet on disk and the calls of `notify` on it."""

    def __init__(self, folder, channels):
        self.folder, self.channels = folder, channels

    def call(self, *rows, **more):
        (self.folder / "rows.json").write_text(json.dumps({"robots": rows}))
        files = (self.folder / name for name in ("outbox.json", "messages.prom"))
        return notify(self.folder / "rows.json", self.channels, *files, now=HOUR, **more)

    @property
    def kept(self):
        return "".join(path.read_text() for path in self.folder.iterdir())


@contextmanager
def serving(server):
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
    thread.start()
    try:
        yield server
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


class Mail(socketserver.StreamRequestHandler):
    """As much of SMTP as a client needs."""

    def handle(self):
        self.wfile.write(b"220 here\r\n")
        while line := self.rfile.readline():
            verb = line[:4].upper()
            if verb == b"DATA":
                self.wfile.write(b"354 go on\r\n")
                lines = iter(self.rfile.readline, b".\r\n")
                self.server.mails.append(b"".join(lines).decode())
            self.wfile.write(b"221 bye\r\n" if verb == b"QUIT" else b"250 ok\r\n")
            if verb == b"QUIT":
                return


class Hook(BaseHTTPRequestHandler):
    """Keeps what is posted; answers with the server's status."""

    def do_POST(self):
        self.server.posts.append(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
        self.send_response(self.server.status)
        self.end_headers()

    def log_message(self, *words):
        pass


@contextmanager
def web():
    with serving(HTTPServer(("127.0.0.1", 0), Hook)) as server:
        server.posts, server.status = [], 200
        yield server


def test_an_alarm_goes_to_a_webhook_once_and_its_end_too(tmp_path, monkeypatch):
    with web() as server:
        monkeypatch.setenv("HOOK", f"json://127.0.0.1:{server.server_port}/{SECRET}")
        desk = Desk(tmp_path, [{"name": "hook", "env": "HOOK"}])
        assert desk.call(robot(episode()), time_zone="Europe/Berlin") == []
        assert desk.call(robot(episode())) == []
        assert desk.call(robot()) == []
        assert desk.call(robot()) == []
    assert [post["type"] for post in server.posts] == ["warning", "success"]
    first, last = [post["message"] for post in server.posts]
    assert "ALARM  cell_3, axis 3 (elbow): Coulomb friction +7.5 % now, limit 20 %; limit not before" in first
    assert "limit not before Sat 2026-01-03" in first
    assert "first alarm 2026-01-01 01:00 CET" in first
    assert last == "ENDED  cell_3, axis 3 (elbow): resolved"
    assert SECRET not in desk.kept


def test_an_alarm_goes_out_by_mail(tmp_path):
    with serving(socketserver.ThreadingTCPServer(("127.0.0.1", 0), Mail)) as server:
        server.mails = []
        address = f"mailto://127.0.0.1:{server.server_address[1]}?from=robots@example.org&to=shift@example.org"
        (tmp_path / "address").mkdir()
        (tmp_path / "address/mail").write_text(f"# the shift\n{address}\n")
        (tmp_path / "desk").mkdir()
        desk = Desk(tmp_path / "desk", [{"name": "mail", "file": str(tmp_path / "address/mail")}])
        assert desk.call(robot(episode())) == []
        assert desk.call(robot(episode())) == []
    assert len(server.mails) == 1
    assert "Robot wear: 1 new" in server.mails[0].replace("_", " ").replace("=3A", ":")
    assert "shift@example.org" not in desk.kept


def test_a_service_that_is_down_loses_nothing_and_stops_nothing(tmp_path, monkeypatch):
    with web() as server:
        monkeypatch.setenv("HOOK", f"json://127.0.0.1:{server.server_port}/{SECRET}")
        desk = Desk(tmp_path, [{"name": "lost", "env": "NOT_SET"}, {"name": "hook", "env": "HOOK"}])
        server.status = 500
        failed = desk.call(robot(episode()))
        assert [line.split(":")[0] for line in failed] == ["lost", "hook"]
        assert "environment variable NOT_SET is not set" in failed[0]
        assert SECRET not in "".join(failed)
        assert 'jointwear_messages_waiting{channel="hook"} 1.0' in desk.kept
        desk.call(robot())
        server.status, server.posts = 200, []
        failed = desk.call(robot())
    assert [line.split(":")[0] for line in failed] == ["lost"]
    assert ["ALARM" in server.posts[0]["message"], "ENDED" in server.posts[1]["message"]] == [True, True]
    waiting = json.loads((tmp_path / "outbox.json").read_text())["waiting"]
    assert [message["channel"] for message in waiting] == ["lost", "lost"]
    assert 'jointwear_messages_waiting{channel="hook"} 0.0' in desk.kept


def test_friction_that_comes_back_by_itself_is_told_as_such_and_again_when_it_returns(tmp_path):
    said = []
    desk = Desk(tmp_path, [{"name": "x", "env": "X"}])
    for active in (True, False, False, True):
        desk.call(robot(episode(active=active)), send=lambda channel, message: said.append(message["body"]) or "")
    assert [body.split()[0] for body in said] == ["ALARM", "ENDED", "AGAIN"]
    assert "no event says why" in said[1]


def test_an_episode_that_takes_the_name_of_the_other_friction_is_neither_new_nor_resolved(tmp_path):
    outbox = Outbox.open(tmp_path / "outbox.json")
    viscous = episode(key="3|viscous friction|model|") | {"quantity": "viscous friction"}
    for row in (robot(episode()), robot(viscous)):
        outbox.note("shift", notices([row], zone_of(None)), {"cell_3"}, HOUR)
    (message,) = outbox.waiting
    assert "ALARM" in message["body"]
    assert list(outbox.told["shift"]) == ["cell_3|3|viscous friction|model|"]
    outbox.note("shift", notices([robot()], zone_of(None)), {"cell_3"}, HOUR)
    assert "resolved" in outbox.waiting[-1]["body"]


def closed(kind, key="3|coulomb friction|model|", **more):
    event = {"time": HOUR + 1800.0, "kind": kind, "note": "seen by Ms Müller"}
    named = {"key": key, "axis": 3, "quantity": "coulomb friction", "detector": "model"}
    return {**named, "event": event, **more}


@pytest.mark.parametrize(
    ("kind", "line", "title", "sort"),
    [
        ("service", "ENDED  cell_3, axis 3 (elbow): service of 2026-01-01 01:30 CET: seen by Ms Müller",
         "Robot wear: 1 ended", "success"),
        ("sensor", "ENDED  cell_3, axis 3 (elbow): sensor of 2026-01-01 01:30 CET: seen by Ms Müller",
         "Robot wear: 1 ended", "success"),
        ("acknowledged", ("CLOSED cell_3, axis 3 (elbow): acknowledged 2026-01-01 01:30 CET: seen by Ms Müller; "
         "Coulomb friction +7.5 %, limit 20 %"), "Robot wear: 1 closed", "info"),
    ],
)  # fmt: skip
def test_an_end_says_which_event_closed_the_alarm(tmp_path, monkeypatch, kind, line, title, sort):
    event = closed(kind)["event"]
    after = {**axis_row(), "event": event, "until": HOUR + 3600.0}
    with web() as server:
        monkeypatch.setenv("HOOK", f"json://127.0.0.1:{server.server_port}/{SECRET}")
        desk = Desk(tmp_path, [{"name": "hook", "env": "HOOK"}])
        desk.call(robot(episode()), time_zone="Europe/Berlin")
        for _ in range(2):
            desk.call(robot(closed=[closed(kind)], axes=[after]), time_zone="Europe/Berlin")
    (_, post) = server.posts
    assert (post["message"], post["title"], post["type"]) == (line, title, sort)


def test_of_an_axis_that_was_judged_since_no_old_growth_is_told_with_its_end():
    row = robot(closed=[closed("acknowledged")])
    (told,) = closures([row], zone_of(None)).values()
    assert told.words == "acknowledged 2026-01-01 00:30 UTC: seen by Ms Müller"


def test_an_alarm_that_follows_a_closed_one_is_a_new_one(tmp_path):
    said = []
    desk = Desk(tmp_path, [{"name": "x", "env": "X"}])
    later = robot(episode(key="3|coulomb friction|model|1"), closed=[closed("service")])
    for row in (robot(episode()), later, later):
        desk.call(row, send=lambda channel, message: said.append(message["body"]) or "")
    assert [line.split()[0] for line in "\n".join(said).splitlines()] == ["ALARM", "ALARM", "ENDED"]


def test_an_alarm_whose_number_changes_is_neither_new_nor_ended(tmp_path):
    """Episodes before it are forgotten with their logs, or had another number in an earlier version."""
    said = []
    desk = Desk(tmp_path, [{"name": "x", "env": "X"}])
    for number in ("", "1767225600", "1"):
        row = robot(episode(key=f"3|coulomb friction|model|{number}"))
        desk.call(row, send=lambda channel, message: said.append(message["body"]) or "")
    assert len(said) == 1


def test_robots_that_left_the_configuration_are_told_of_once(tmp_path):
    said = []
    desk = Desk(tmp_path, [{"name": "x", "env": "X"}])

    def call(*rows, left=()):
        (tmp_path / "rows.json").write_text(json.dumps({"robots": rows, "left": left}))
        files = [tmp_path / name for name in ("rows.json", "outbox.json", "messages.prom")]
        notify(files[0], desk.channels, *files[1:], now=HOUR, send=lambda _, m: said.append(m) or "")

    four = episode(axis=4, key="4|backlash|model|")
    call(robot(episode(), four), robot(episode(), name="other"))
    # Of another configuration in the same folder nothing is known here.
    call(robot(name="third"))
    call(robot(name="third"), left=["cell_3"])
    call(robot(name="third"), left=["cell_3"])
    assert [m["body"] for m in said[1:]] == ["ENDED  cell_3: no longer in the configuration"]
    assert not said[1]["good"]


def test_newest_logs_that_are_refused_are_told_once_and_their_end_too():
    refused = robot(refused_newest=3, refusals=["logs/a.csv: the sign of the torque looks flipped"])
    (told,) = notices([refused], zone_of(None))
    assert told.key == "cell_3|refused"
    assert told.words == "the newest logs are refused (3): logs/a.csv: the sign of the torque looks flipped"
    assert notices([robot()], zone_of(None)) == []


def test_a_robot_that_is_refused_has_not_recovered(tmp_path):
    said = []
    desk = Desk(tmp_path, [{"name": "x", "env": "X"}])
    refused = robot(result="refused", reason="the folder is gone", axes=[])
    for row in (robot(episode()), refused, refused, robot(episode())):
        desk.call(row, send=lambda channel, message: said.append(message["body"]) or "")
    assert [body.split()[0] for body in said] == ["ALARM", "ALARM", "ENDED"]
    assert "refused: the folder is gone" in said[1]
    assert said[2] == "ENDED  cell_3: resolved"


def test_channels_hear_of_their_robots_and_nothing_of_the_paper(tmp_path):
    said = []
    desk = Desk(tmp_path, [{"name": "x", "env": "X", "robots": ["a"]}, {"name": "y", "env": "Y"}])
    paper = episode(detector="paper", key="3|torque histogram|paper|")
    rows = [robot(episode(), paper, name="a"), robot(paper, name="b"), robot(episode(), name="c")]
    desk.call(*rows, send=lambda channel, message: said.append((channel["name"], message["title"])) or "")
    assert said == [("x", "Robot wear: 1 new"), ("y", "Robot wear: 2 new")]
    assert len(notices(rows, zone_of(None))) == 2


def test_a_long_message_counts_what_it_leaves_out_and_a_failed_one_how_often_it_was_tried(tmp_path):
    desk = Desk(tmp_path, [{"name": "x", "env": "X"}])
    rows = [robot(episode(), name=f"cell_{k}") for k in range(MOST_LINES + 5)]
    for _ in range(3):
        assert desk.call(*rows, send=lambda channel, message: "is down") == ["x: is down"]
    (message,) = Outbox.open(tmp_path / "outbox.json").waiting
    assert message["attempts"] == 3
    assert message["title"] == f"Robot wear: {MOST_LINES + 5} new"
    *lines, rest = message["body"].splitlines()
    assert len(lines) == MOST_LINES
    assert rest == "... and 5 more on the page of the fleet"


def test_messages_for_a_channel_that_is_gone_do_not_wait_for_ever(tmp_path):
    folder = tmp_path
    assert Desk(folder, [{"name": "old", "env": "OLD"}]).call(robot(episode()), send=lambda *_: "is down")
    said = []
    desk = Desk(folder, [{"name": "new", "env": "NEW"}])
    desk.call(robot(episode()), send=lambda channel, message: said.append(channel["name"]) or "")
    assert said == ["new"]
    assert Outbox.open(folder / "outbox.json").waiting == []
    # What a channel was told is kept: put back, it hears of the end alone.
    desk = Desk(folder, [{"name": "old", "env": "OLD"}])
    desk.call(robot(), send=lambda channel, message: said.append(message["body"]) or "")
    assert said[1:] == ["ENDED  cell_3, axis 3 (elbow): resolved"]


def test_a_broken_outbox_is_not_thrown_away(tmp_path):
    (tmp_path / "outbox.json").write_text("{")
    with pytest.raises(InputError, match="messages may wait in it"):
        Desk(tmp_path, []).call(robot())
    assert (tmp_path / "outbox.json").read_text() == "{"


@given(st.lists(st.tuples(st.frozensets(st.integers(1, 4)), st.booleans()), max_size=12))
@settings(max_examples=60, deadline=None)
def test_what_was_heard_is_what_is(history):
    """However services fail, a channel that is reached at last knows every alarm that is there, each told once."""
    box, heard = Outbox("/dev/null"), []
    box.save = lambda: None
    for keys, up in [*history, (frozenset(), True)]:
        found = [Notice(f"r|{key}", "r", f"axis {key}", "words") for key in sorted(keys)]
        box.note("x", found, {"r"}, 0.0)
        box.deliver(["x"], lambda _, message, up=up: heard.extend(message["body"].splitlines()) or "" if up else "down")
        if up:
            open_now = [line.split(":")[0].split("  ")[1] for line in heard if line.startswith("ALARM")]
            for line in heard:
                if line.startswith("ENDED"):
                    open_now.remove(line.split(":")[0].split("  ")[1])
            assert sorted(open_now) == [f"axis {key}" for key in sorted(keys)]
            assert not box.waiting


def test_secrets_are_blotted_out():
    told = blot(f"https://hooks.example.org/{SECRET}/x refused user bob99", [f"slack://bob99@{SECRET}/x"])
    assert SECRET not in told
    assert "bob99" not in told


@pytest.mark.parametrize(
    ("channel", "words"),
    [
        ({"name": "a"}, "either by 'env'"),
        ({"name": "a", "env": "A", "file": "b"}, "either by 'env'"),
        ({"name": "a", "env": "A", "robots": ["cell_4"]}, "did you mean 'cell_3'"),
    ],
)
def test_a_wrong_channel_is_named(channel, words):
    with pytest.raises(InputError, match=words):
        check_channels({"notify": [channel], "robots": {"cell_3": {}}})
    with pytest.raises(InputError, match="given twice"):
        check_channels({"notify": [{"name": "a", "env": "A"}] * 2, "robots": {}})


@pytest.mark.parametrize("channel", [{"env": f"https://hooks.example/{SECRET}"}, {"file": f"slack://{SECRET}/a"}])
def test_an_address_in_the_place_of_its_name_is_not_repeated(root, channel):
    given = yaml.safe_load((root / "config/config.yaml").read_text())
    given["monitor"] = {"robots": {}, "notify": [{"name": "shop", **channel}]}
    with pytest.raises(InputError, match="not repeated here") as error:
        check_channels(prepare(given)["monitor"])
    assert SECRET not in str(error.value)
    assert ("the name of an environment variable" if "env" in channel else "the path of a file") in str(error.value)


def test_a_channel_without_an_address_is_told_though_nothing_is_to_be_sent(tmp_path, monkeypatch):
    monkeypatch.setenv("SHOP_URL", f"json://{SECRET}")
    monkeypatch.delenv("OFFICE_URL", raising=False)
    channels = [{"name": "shop", "env": "SHOP_URL"}, {"name": "office", "env": "OFFICE_URL"}]
    channels.append({"name": "cell", "file": str(tmp_path / "gone")})
    told = without_address(channels)
    assert told[0] == "office: environment variable OFFICE_URL is not set or empty"
    assert told[1].startswith("cell: file ")
    assert len(told) == 2
