"""Hide a cause in synthetic tables and name it."""

from jointwear.recovery.validation import validate_case
from jointwear.script import reported

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
