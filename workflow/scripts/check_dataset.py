"""Check one data set before discovery."""

import sys

from jointwear.discovery.preflight import write_check
from jointwear.discovery.settings import settings_of
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        found = write_check(
            snakemake.wildcards.dataset,
            snakemake.params.entry,
            snakemake.input.robot,
            settings_of(snakemake.params.entry),
            snakemake.output.check,
            snakemake.output.page,
        )
        if found.refused:
            print(
                f"jointwear: discovery would refuse {found.dataset}: {found.refused}; {found.suggestion}",
                file=sys.stderr,
            )
