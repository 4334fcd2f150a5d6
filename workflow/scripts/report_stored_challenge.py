"""Write the page of the hidden-effect test from the summary kept with the project."""

from jointwear.running.script import reported
from jointwear.studies.hidden_effect_page.stored import write_stored_page

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_stored_page(
            snakemake.input.scores,
            next(iter(snakemake.input.get("peers", [])), None),
            snakemake.output[0],
            next(iter(snakemake.input.get("world", [])), None),
            next(iter(snakemake.input.get("limits", [])), None),
        )
