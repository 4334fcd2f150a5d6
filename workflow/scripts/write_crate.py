"""Pack the run of the report as a Workflow Run RO-Crate."""

from jointwear.publishing.crate.writing import agent_of, write_crate
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_crate(snakemake.output[0], [snakemake.input.page], snakemake.params.config, agent=agent_of())
