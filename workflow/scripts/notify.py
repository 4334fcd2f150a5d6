"""Tell every channel of alarms and of their ends; a channel that cannot be reached stops nothing."""

import sys

from jointwear.monitor.notify.channels import without_address
from jointwear.monitor.notify.stage import notify
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        failed = notify(
            snakemake.input.rows,
            snakemake.params.channels,
            snakemake.params.outbox,
            snakemake.params.metrics,
            time_zone=snakemake.params.time_zone,
        )
        for line in failed:
            print(f"jointwear: not sent, kept for the next call: {line}", file=sys.stderr)
        # Else an alarm would be the first to find out.
        for line in without_address(snakemake.params.channels):
            if line not in failed:
                print(f"jointwear: nothing can be sent: {line}", file=sys.stderr)
