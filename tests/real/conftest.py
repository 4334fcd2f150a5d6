"""Measured data of real robots: none of them is part of the project (data/registry.yaml)."""

import pytest

from jointwear.files.registered import locate, read_registry


@pytest.fixture(scope="session", autouse=True)
def registered_data():
    """Say what is missing before any test of real data runs."""
    needed = [f"registry:{name}/{file}" for name, entry in read_registry().items() for file in entry["files"]]
    missing = [reference for reference in needed if not locate(reference).is_file()]
    if missing:
        pytest.exit(
            f"the data of real robots are not here ({', '.join(missing)}): set JOINTWEAR_DATA to a folder that holds "
            "them, or load them with `snakemake --cores 1 fetch_data`",
            returncode=1,
        )
