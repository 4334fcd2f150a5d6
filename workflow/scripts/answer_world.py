"""Make one batch of the tier "world" and give it to discovery."""

from jointwear.running.script import reported
from jointwear.studies.world.stages import answer_batch

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        answer_batch(snakemake.wildcards.world_set, int(snakemake.wildcards.batch), snakemake.output[0])
