"""Judge a batch of robots of the shop floor at every stated rate."""

from jointwear.running.script import reported
from jointwear.studies.shop_floor.stages import judge_batch

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        words = snakemake.wildcards
        judge_batch(words.shop_seeds, words.shop_batch, snakemake.input.windows, snakemake.output[0])
