"""Give one batch of the hidden-effect test to discovery."""

from jointwear.running.script import reported
from jointwear.studies.challenge.solve import solve_batch

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        solve_batch(snakemake.input.data, snakemake.output.verdicts, snakemake.output.torque, {})
