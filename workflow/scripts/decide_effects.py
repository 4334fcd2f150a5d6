"""Score every candidate effect and decide."""

from jointwear.discovery.stages import decide_effects
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        decide_effects(
            snakemake.input.recording,
            snakemake.input.robot,
            snakemake.params.entry,
            snakemake.output.decision,
            snakemake.output.robot,
            snakemake.output.retuned,
            snakemake.output.evidence,
        )
