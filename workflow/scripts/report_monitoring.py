"""Write the page of a monitored robot."""

from jointwear.monitor.page import write_page
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_page(snakemake.input.state, snakemake.output.page, snakemake.output.figures, snakemake.params.time_zone)
