"""Draw one figure of the multiverse."""

from jointwear.multiverse.figures import draw
from jointwear.script import reported

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
