"""Pack a run with its workflow, inputs, results, checksums, software, seed and agent as a Workflow Run RO-Crate.

The profile is Workflow Run Crate 0.5 (https://w3id.org/ro/wfrun/workflow/0.5) on RO-Crate 1.1. Same run, same bytes,
but for dates.
"""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import yaml
from rocrate.model.contextentity import ContextEntity
from rocrate.model.creativework import CreativeWork
from rocrate.rocrate import ROCrate

from jointwear import __version__
from jointwear.files.documents import read_yaml
from jointwear.files.json_documents import read_json
from jointwear.publishing.crate.layout import COMMIT, CONFIG, FILES, METADATA, PROJECT, PROJECT_FILES, files_of
from jointwear.publishing.crate.records import Run, trace
from jointwear.publishing.crate.software import software
from jointwear.publishing.report import origin
from jointwear.publishing.soundness import check_results, checksum
from jointwear.running.configuration import CONFIG as OWN_CONFIG
from jointwear.running.configuration import OF_THE_USER, config_schema, experiment_of

PROFILES = (
    ("https://w3id.org/ro/wfrun/process/0.5", "Process Run Crate", "0.5"),
    ("https://w3id.org/ro/wfrun/workflow/0.5", "Workflow Run Crate", "0.5"),
    ("https://w3id.org/workflowhub/workflow-ro-crate/1.0", "Workflow RO-Crate", "1.0"),
)
# The one term that is not in the context of RO-Crate 1.1.
TERMS = {"sha256": "https://w3id.org/ro/terms/workflow-run#sha256"}
LICENCE = "https://spdx.org/licenses/BSD-3-Clause"
BIOSCHEMAS = "https://bioschemas.org/profiles/ComputationalWorkflow/1.0-RELEASE"
PARAMETER = "https://bioschemas.org/profiles/FormalParameter/1.0-RELEASE"
FORMATS = {
    ".cff": "application/yaml",
    ".csv": "text/csv",
    ".html": "text/html",
    ".j2": "text/x-jinja2",
    ".json": "application/json",
    ".md": "text/markdown",
    ".nc": "application/x-netcdf",
    ".py": "text/x-python",
    ".smk": "text/x-snakemake",
    ".svg": "image/svg+xml",
    ".toml": "application/toml",
    ".urdf": "application/xml",
    ".yaml": "application/yaml",
}


@dataclass(frozen=True)
class Agent:
    """Who ran the workflow: a name, and an identifier such as an ORCID (https://orcid.org/...) if there is one."""

    name: str = "not named"
    identifier: str | None = None


def agent_of() -> Agent:
    """Return the agent that AGENT (a name) and ORCID (an address or the bare number) of the environment name."""
    orcid = os.environ.get("ORCID") or None
    if orcid and not orcid.startswith("https://"):
        orcid = f"https://orcid.org/{orcid}"
    return Agent(os.environ.get("AGENT") or Agent.name, orcid)


def write_crate(
    output: str | Path, wanted: Sequence[str], config: Mapping[str, Any], *, root: str | Path = ".", agent: Agent
) -> None:
    """Write the crate of the run that made the wanted files.

    Parameters
    ----------
    output : folder of the crate; what it held is replaced when the new crate is complete.
    wanted : result files, relative to `root`; everything that they were made from comes with them.
    config : the configuration of the run, complete but for the user's own data sets and robots.
    root : folder of the project.
    agent : who ran the workflow.

    Raises
    ------
    InputError : if a result is missing, damaged, or not what the jobs after it have read.
    """
    root, output = Path(root), Path(output)
    run = trace(wanted, root)
    check_results(root, [*_result_files(run, root)], run.checksums)
    with tempfile.TemporaryDirectory(dir=output.resolve().parent, prefix=".crate-") as name:
        own, done = Path(name) / "own", Path(name) / "crate"
        files = {path: root / path for path in (*_project_files(root), *_result_files(run, root))}
        files.update(_own_files(own, run, config, files, root))
        _describe(files, run, config, agent).write(done)
        _settle(done / METADATA)
        shutil.rmtree(output, ignore_errors=True)
        done.rename(output)


def _project_files(root: Path) -> Iterator[str]:
    """Names of the project's own files, sorted."""
    yield from files_of(root, PROJECT)
    yield from (name for name in PROJECT_FILES if (root / name).is_file())


def _result_files(run: Run, root: Path) -> Iterator[str]:
    """Names of the result files of a run; a result that is a folder counts with all it holds."""
    for name in run.results:
        if (root / name).is_dir():
            yield from (p.relative_to(root).as_posix() for p in sorted((root / name).rglob("*")) if p.is_file())
        else:
            yield name


def _own_files(folder: Path, run: Run, config: Mapping, files: Mapping[str, Path], root: Path) -> dict[str, Path]:
    """Write the configuration, the commit and the list of files; return them by their names in the crate.

    The project's own configuration is written anew where it holds data sets and robots of the user.
    """
    made = {name: run.results[name].rule for name in files if name in run.results}
    listed = {
        "results": {
            name: {"sha256": checksum(path), "bytes": path.stat().st_size, "rule": made.get(name)}
            for name, path in sorted(files.items())
            if name in made or _inside(name, run.results)
        },
        "inputs": [name for name in run.sources if name in files],
        "wanted": sorted(name for name in run.results if not _used(name, run)),
        "software": software(),
        "seed": config["seed"],
    }
    texts = {
        CONFIG: yaml.safe_dump(dict(config), sort_keys=False),
        FILES: json.dumps(listed, indent=1, sort_keys=True) + "\n",
        COMMIT: json.dumps(origin.commit(root), sort_keys=True) + "\n",
    }
    given = read_yaml(files[OWN_CONFIG]) if OWN_CONFIG in files else {}
    if any(value for section in OF_THE_USER for value in (given.get(section) or {}).values()):
        # Robots of a plant are nobody else's business, and who verifies the crate does not have their logs.
        texts[OWN_CONFIG] = yaml.safe_dump(experiment_of(given), sort_keys=False)
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return {name: folder / name for name in texts}


def _inside(name: str, folders: Mapping[str, Any]) -> bool:
    return any(parent.as_posix() in folders for parent in Path(name).parents)


def _used(name: str, run: Run) -> bool:
    return any(name in made.inputs for made in run.results.values())


def _describe(files: Mapping[str, Path], run: Run, config: Mapping, agent: Agent) -> ROCrate:
    """Return the crate with all its entities, not yet written."""
    crate = ROCrate(version="1.1")
    crate.metadata.extra_contexts.append(TERMS)
    root = crate.root_dataset
    root["name"] = "Wear in industrial robots: a run of the workflow jointwear"
    root["description"] = (
        "The reproduction of a simulation study of wear detection in industrial robots: workflow, configuration, "
        "inputs and every result with its checksum. `snakemake verify --config crate=PATH` computes it again."
    )
    root["license"] = crate.add(CreativeWork(crate, LICENCE, {"name": "BSD 3-clause licence"}))
    root["conformsTo"] = [
        crate.add(CreativeWork(crate, address, {"name": name, "version": version}))
        for address, name, version in PROFILES
    ]
    root["keywords"] = "robotics, condition monitoring, friction, wear, reproducibility"
    entities = {name: _add_file(crate, name, path) for name, path in sorted(files.items()) if name != "Snakefile"}
    workflow = crate.add_workflow(
        files["Snakefile"], "Snakefile", main=True, lang="snakemake", properties=_facts("Snakefile", files["Snakefile"])
    )
    workflow["name"] = "jointwear"
    workflow["conformsTo"] = crate.add(
        CreativeWork(crate, BIOSCHEMAS, {"name": "Bioschemas ComputationalWorkflow", "version": "1.0-RELEASE"})
    )
    workflow["version"] = __version__
    workflow["license"] = {"@id": LICENCE}
    workflow["softwareRequirements"] = [_software(crate, name, version) for name, version in software().items()]
    parameters, values = _parameters(crate, config)
    data_in = _collection(crate, "input-files", "Files that the run starts from", True)
    data_out = _collection(crate, "result-files", "Every file that the run made", False)
    workflow["input"] = [data_in, *parameters]
    workflow["output"] = data_out
    if "README.md" in entities:
        entities["README.md"]["about"] = root
    listed = [entities[name] for name in run.sources if name in entities]
    results = [entities[name] for name in files if name in run.results or _inside(name, run.results)]
    for entity in listed:
        entity.append_to("exampleOfWork", data_in)
    for entity in results:
        entity.append_to("exampleOfWork", data_out)
    action = crate.add_action(
        workflow,
        identifier="#run",
        object=[*listed, entities[CONFIG], *values],
        result=results,
        properties={
            "name": f"Run of jointwear {__version__} with seed {config['seed']}",
            "description": f"{len({(m.rule, m.inputs) for m in run.results.values()})} jobs by Snakemake",
            "startTime": _date(run.begin),
            "endTime": _date(run.end),
            "actionStatus": "http://schema.org/CompletedActionStatus",
        },
    )
    action["agent"] = crate.add(
        ContextEntity(crate, agent.identifier or "#agent", {"@type": "Person", "name": agent.name})
    )
    root["author"] = crate.add(
        ContextEntity(crate, "#authors", {"@type": "Organization", "name": "The jointwear developers"})
    )
    root["mentions"] = action
    workflow["creator"] = root["author"]
    return crate


def _facts(name: str, path: Path) -> dict[str, Any]:
    return {
        "name": name,
        "contentSize": str(path.stat().st_size),
        "sha256": checksum(path),
        "encodingFormat": FORMATS.get(Path(name).suffix, "text/plain"),
    }


def _add_file(crate: ROCrate, name: str, path: Path) -> Any:
    return crate.add_file(path, name, properties=_facts(name, path))


def _software(crate: ROCrate, name: str, version: str) -> Any:
    identifier = f"pkg:{'generic' if name == 'python' else 'pypi'}/{name}@{version}"
    return crate.dereference(identifier) or crate.add(
        ContextEntity(
            crate,
            identifier,
            {"@type": "SoftwareApplication", "name": name, "softwareVersion": version},
        )
    )


def _collection(crate: ROCrate, name: str, words: str, required: bool) -> Any:
    return crate.add_formal_parameter(
        name,
        "File",
        identifier=f"#parameter-{name}",
        description=words,
        valueRequired=required,
        properties={"conformsTo": {"@id": PARAMETER}, "multipleValues": "True"},
    )


def _parameters(crate: ROCrate, config: Mapping[str, Any]) -> tuple[list, list]:
    """Add every key of the configuration as a formal parameter with its value; return both lists."""
    described = _descriptions(config_schema())
    parameters, values = [], []
    crate.add(CreativeWork(crate, PARAMETER, {"name": "FormalParameter profile", "version": "1.0-RELEASE"}))
    for key, value in sorted(_flat(config)):
        kind = {bool: "Boolean", int: "Integer", float: "Float"}.get(type(value), "Text")
        parameter = crate.add_formal_parameter(
            key,
            kind,
            identifier=f"#parameter-{key}",
            description=described.get(key, key),
            valueRequired=True,
            properties={"conformsTo": {"@id": PARAMETER}},
        )
        entity = ContextEntity(
            crate,
            f"#value-{key}",
            {"@type": "PropertyValue", "name": key, "value": value if kind != "Text" else _text(value)},
        )
        entity["exampleOfWork"] = parameter
        parameters.append(parameter)
        values.append(crate.add(entity))
    return parameters, values


def _text(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, sort_keys=True)


def _flat(config: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in config.items():
        if isinstance(value, Mapping) and value:
            yield from _flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _descriptions(schema: Mapping[str, Any], prefix: str = "") -> dict[str, str]:
    found: dict[str, str] = {}
    for key, inner in schema.get("properties", {}).items():
        found[f"{prefix}{key}"] = inner.get("description", key)
        found.update(_descriptions(inner, f"{prefix}{key}."))
    return found


def _date(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="seconds")


def _settle(path: Path) -> None:
    """Write the metadata with entities and keys in one order."""
    document = read_json(path)
    document["@graph"].sort(key=lambda entity: entity["@id"])
    for entity in document["@graph"]:
        for key, value in entity.items():
            if isinstance(value, list) and all(isinstance(v, dict) and "@id" in v for v in value):
                entity[key] = sorted(value, key=lambda v: v["@id"])
    path.write_text(json.dumps(document, indent=1, sort_keys=True, ensure_ascii=False) + "\n", encoding="utf-8")
