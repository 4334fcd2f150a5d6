"""The public RO-Crate validator without a network: its cache is filled with the context that crates name."""

from __future__ import annotations

import io
import json
from importlib.util import find_spec
from pathlib import Path

import requests
import requests_cache
import urllib3
from rocrate_validator import models, services

CONTEXT = "https://w3id.org/ro/crate/1.1/context"
KIND = "application/ld+json"


#: Terms that version 1.1 of the context has under other addresses than the newer one that `rocrate` ships.
AS_IN_1_1 = {
    "ComputationalWorkflow": "https://bioschemas.org/ComputationalWorkflow",
    "FormalParameter": "https://bioschemas.org/FormalParameter",
    "input": "https://bioschemas.org/ComputationalWorkflow#input",
    "output": "https://bioschemas.org/ComputationalWorkflow#output",
}


def fill_cache(cache: Path) -> None:
    """Store the context that `rocrate` ships as the answer that the validator would get for that of RO-Crate 1.1."""
    shipped = Path(find_spec("rocrate").submodule_search_locations[0]) / "data/ro-crate.jsonld"
    document = json.loads(shipped.read_text(encoding="utf-8"))
    document["@context"].update(AS_IN_1_1)
    body = json.dumps(document).encode()
    answer = requests.Response()
    answer.status_code, answer.url, answer.headers["Content-Type"] = 200, CONTEXT, KIND
    answer._content = body
    answer.raw = urllib3.HTTPResponse(
        body=io.BytesIO(body), status=200, headers={"Content-Type": KIND}, preload_content=False
    )
    accepted = {"Accept": "application/ld+json, application/json, */*;q=0.1"}
    answer.request = requests.Request("GET", CONTEXT, headers=accepted).prepare()
    session = requests_cache.CachedSession(str(cache), backend="sqlite", expire_after=-1)
    session.cache.save_response(answer)
    session.close()


def problems(crate: Path, cache: Path, profile: str = "workflow-run-crate") -> list[str]:
    """Return what the validator finds against the required rules of a profile, or None of which was left out."""
    settings = services.ValidationSettings(
        rocrate_uri=str(crate),
        profile_identifier=profile,
        requirement_severity=models.Severity.REQUIRED,
        offline=True,
        cache_path=cache,
        skip_availability_check=True,
    )
    result = services.validate(settings)
    found = [f"{issue.check.identifier}: {issue.message}" for issue in result.get_issues()]
    if not found and not result.passed():
        found = ["the validator did not pass the crate"]
    return found
