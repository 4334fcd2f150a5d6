"""Give one batch of the hidden-effect test to discovery."""

from jointwear.challenge.solve import solve_batch
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        solve_batch(snakemake.input.data, snakemake.output.verdicts, snakemake.output.torque, {})
