"""Draw Tables II and IV as pictures."""

from jointwear.publishing.figures.maps import draw_maps
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw_maps(
            snakemake.input.lags,
            snakemake.input.detection,
            snakemake.output.lags,
            snakemake.output.detection,
            snakemake.params.replicate,
        )
