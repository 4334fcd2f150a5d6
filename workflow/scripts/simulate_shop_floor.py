"""Simulate a batch of robots of the shop floor into window statistics."""

from jointwear.running.script import reported
from jointwear.studies.shop_floor.kept import simulate_batch

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        simulate_batch(snakemake.wildcards.shop_seeds, snakemake.wildcards.shop_batch, snakemake.output[0])
