"""Write the page of a monitored robot."""

import sys

from jointwear.monitor.judging.early_events import early_events
from jointwear.monitor.judging.state import read_state
from jointwear.monitor.presentation.page import write_page
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        state = read_state(snakemake.input.state)
        more = snakemake.params.time_zone, snakemake.params.example
        write_page(state, snakemake.output.page, snakemake.output.figures, *more)
        for words in early_events(state.findings, snakemake.params.time_zone):
            print(f"jointwear: {state.name}: {words}", file=sys.stderr)
