"""The public RO-Crate validator without a network: its cache is filled with the context that crates name."""

from __future__ import annotations

import io
from pathlib import Path

import requests
import requests_cache
import urllib3
from rocrate_validator import models, services

CONTEXT = "https://w3id.org/ro/crate/1.1/context"
KIND = "application/ld+json"


def fill_cache(cache: Path, document: Path) -> None:
    """Store a document as the answer that the validator would get for the context of RO-Crate 1.1."""
    body = document.read_bytes()
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
