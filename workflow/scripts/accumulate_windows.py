"""Turn a batch of logs into window statistics."""

import sys

from jointwear.monitor.reading.reading_stages import accumulate_windows
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0], absent=["pandas"]):
        refused = accumulate_windows(
            snakemake.params.logs,
            snakemake.input.survey,
            snakemake.input.robot,
            snakemake.params.entry,
            snakemake.output[0],
        )
        for line in refused:
            print(f"jointwear: refused: {line}", file=sys.stderr)
