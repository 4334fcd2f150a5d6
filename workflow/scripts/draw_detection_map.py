"""Draw Table IV as a picture."""

from jointwear.publishing.figures.detection_map import draw_detection_map
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw_detection_map(snakemake.input.table, snakemake.output[0])
