"""Draw Table II as a picture."""

from jointwear.publishing.figures.lag_map import draw_lag_map
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw_lag_map(snakemake.input.table, snakemake.output[0], snakemake.params.replicate)
