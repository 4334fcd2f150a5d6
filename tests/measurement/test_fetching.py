"""Fetching registered data from a server of this machine."""

import hashlib
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import numpy as np
import pytest
import yaml

from jointwear.files.errors import InputError
from jointwear.files.storage import read_variables
from jointwear.measurement.fetching import fetch
from jointwear.measurement.published.staubli_tx40 import OFFSET, RATIO

URDF = '<robot name="a"><link name="tip"><visual/></link><joint name="tip" type="fixed"/></robot>'


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@pytest.fixture
def server(tmp_path):
    folder = tmp_path / "served"
    folder.mkdir()
    running = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(folder)))
    thread = threading.Thread(target=running.serve_forever, daemon=True)
    thread.start()
    yield folder, f"http://127.0.0.1:{running.server_port}"
    running.shutdown()
    thread.join()


def staubli(folder, address, samples=50, **change):
    """Serve a run of the Staubli in the layout of its makers; return its positions, torques and registry entry."""
    random = np.random.default_rng(1)
    position, torque = random.normal(size=(samples, 6)), random.normal(size=(samples, 6))
    for name, values in (("pos_read_data.csv", (position - OFFSET) @ RATIO.T), ("curr_data.csv", torque)):
        np.savetxt(folder / name, values, delimiter=",", header="1,2,3,4,5,6", comments="", fmt="%.17g")
    (folder / "tx40_mdh_modified.urdf").write_text(URDF)
    rms = {"q": position, "tau": torque @ RATIO}
    entry = {
        "address": address,
        "sources": {"pos_read_data.csv": None, "curr_data.csv": None, "tx40_mdh_modified.urdf": None},
        "convert": "staubli_tx40",
        "files": {
            "measured.nc": {
                "samples": samples,
                "rms": {k: [float(x) for x in np.sqrt(np.mean(v**2, axis=0))] for k, v in rms.items()},
            },
            "robot.urdf": {},
        },
        **change,
    }
    return position, torque, entry


def registry_of(tmp_path, entry):
    path = tmp_path / "registry.yaml"
    path.write_text(yaml.safe_dump({"arm": entry}))
    return path


def test_sources_become_the_registered_files(server, tmp_path):
    position, torque, entry = staubli(*server)
    files = fetch("arm", tmp_path / "out", registry_of(tmp_path, entry), tmp_path / "cache")
    q, tau = read_variables(files[0], "q", "tau")
    np.testing.assert_allclose(q, position, atol=1e-9)
    np.testing.assert_allclose(tau, torque @ RATIO, atol=1e-9)
    assert "visual" not in files[1].read_text()
    assert 'joint name="tip_joint"' in files[1].read_text()
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["measured.nc", "robot.urdf"]


def test_numbers_that_are_not_the_registered_ones_are_refused_and_leave_nothing(server, tmp_path):
    _, _, entry = staubli(*server)
    entry["files"]["measured.nc"]["rms"]["tau"][2] *= 1.01
    with pytest.raises(InputError, match=r"'tau' of measured\.nc does not hold the registered numbers"):
        fetch("arm", tmp_path / "out", registry_of(tmp_path, entry), tmp_path / "cache")
    assert not list((tmp_path / "out").iterdir())


def test_a_wrong_checksum_is_refused(server, tmp_path):
    folder, address = server
    (folder / "log.db3").write_bytes(b"what was served")
    entry = {
        "address": address,
        "sources": {"log.db3": hashlib.sha256(b"what was registered").hexdigest()},
        "convert": "as_it_is",
        "files": {"log.db3": {}},
    }
    with pytest.raises(InputError, match="checksum is wrong"):
        fetch("arm", tmp_path / "out", registry_of(tmp_path, entry), tmp_path / "cache")
    entry["sources"]["log.db3"] = hashlib.sha256(b"what was served").hexdigest()
    (fetched,) = fetch("arm", tmp_path / "out", registry_of(tmp_path, entry), tmp_path / "cache2")
    assert fetched.read_bytes() == b"what was served"


def test_an_address_that_does_not_answer_is_named_with_the_way_out(server, tmp_path):
    _, _, entry = staubli(*server)
    entry["address"] = "http://127.0.0.1:9"
    with pytest.raises(InputError, match="JOINTWEAR_DATA"):
        fetch("arm", tmp_path / "out", registry_of(tmp_path, entry), tmp_path / "cache")
