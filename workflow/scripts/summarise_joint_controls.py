"""Put the controls of the joint fit together for the report."""

from jointwear.running.script import reported
from jointwear.studies.joint_fit.control_summary import write_controls

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_controls(list(snakemake.input.papers), snakemake.output[0])
