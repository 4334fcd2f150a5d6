"""Write the page of a monitored robot."""

from jointwear.monitor.judging.state import read_state
from jointwear.monitor.presentation.page import write_page
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        state = read_state(snakemake.input.state)
        more = snakemake.params.time_zone, snakemake.params.example
        write_page(state, snakemake.output.page, snakemake.output.figures, *more)
