"""Hide a cause in synthetic tables and name it."""

from jointwear.running.script import reported
from jointwear.studies.recovery.validation import validate_case

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        validate_case(
            snakemake.input.robot,
            snakemake.input.published,
            snakemake.output[0],
            snakemake.wildcards.cause,
            int(snakemake.wildcards.number),
            snakemake.params.settings,
        )
