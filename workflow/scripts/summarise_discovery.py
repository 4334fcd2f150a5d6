"""Write the report's chapter on the shipped data set with a hidden effect."""

from jointwear.discovery.presentation.chapter import PICTURES, write_chapter
from jointwear.running.script import reported
from jointwear.studies.challenge.examples import EXAMPLE

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        told = ("effect", "axis", "inertial_error", "drive_error", "noise")
        write_chapter(
            snakemake.input.verdict,
            snakemake.input.where,
            snakemake.input.models,
            {name: EXAMPLE[name] for name in told},
            snakemake.output.chapter,
            {name: snakemake.output[name] for name in PICTURES},
        )
