"""The few answers of a Kubernetes API that Snakemake's executor asks for, on loopback; it keeps what was submitted."""

from __future__ import annotations

import contextlib
import json
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import yaml


class Api:
    """Submitted jobs, as the executor rendered them; every job fails at once, nothing is run."""

    def __init__(self) -> None:
        self.jobs: list[dict] = []
        self.address = ""

    def write_kubeconfig(self, path: Path) -> Path:
        """Write a kubeconfig that leads here."""
        here = {"cluster": {"server": self.address}, "name": "here"}
        context = {"context": {"cluster": "here", "user": "me"}, "name": "here"}
        user = {"name": "me", "user": {"token": "none"}}
        document = {"apiVersion": "v1", "kind": "Config", "current-context": "here"}
        document |= {"clusters": [here], "contexts": [context], "users": [user]}
        path.write_text(yaml.safe_dump(document))
        return path


def _handler(api: Api) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        def _answer(self, document: dict, code: int = 200) -> None:
            body = json.dumps(document).encode()
            self.send_response(code)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def do_POST(self) -> None:
            document = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            if self.path.endswith("/jobs"):
                api.jobs.append(document)
            self._answer(document, 201)

        def do_DELETE(self) -> None:
            self.rfile.read(int(self.headers.get("Content-Length") or 0))
            self._answer({"kind": "Status", "apiVersion": "v1", "status": "Success"})

        def do_GET(self) -> None:
            if "/pods" in self.path:
                self._answer({"kind": "PodList", "apiVersion": "v1", "items": []})
            else:
                self._answer({"kind": "Job", "apiVersion": "batch/v1", "status": {"failed": 1}})

        def log_message(self, *_: object) -> None:
            pass

    return Handler


@contextlib.contextmanager
def kubernetes_api() -> Iterator[Api]:
    """Serve the API on a free port of the loopback interface for the length of a block."""
    api = Api()
    server = ThreadingHTTPServer(("127.0.0.1", 0), _handler(api))
    api.address = f"http://127.0.0.1:{server.server_port}"
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield api
    finally:
        server.shutdown()
        server.server_close()
        thread.join(10)
