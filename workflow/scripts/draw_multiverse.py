"""Draw one figure of the multiverse."""

from jointwear.running.script import reported
from jointwear.studies.multiverse.figures import draw

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw(
            snakemake.wildcards.picture,
            snakemake.input.scored,
            snakemake.input.influence,
            snakemake.input.choice,
            snakemake.input.lag_rule,
            snakemake.output[0],
        )
