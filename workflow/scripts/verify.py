"""Compute a crate again and compare; exit 1 if a file differs."""

import sys

from jointwear.files.errors import InputError
from jointwear.publishing.verification.recomputation import verify
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        if not snakemake.params.crate:
            raise InputError("config: 'crate' is missing; name one with --config crate=PATH (`make crate` writes one)")
        if not verify(snakemake.params.crate, snakemake.threads, snakemake.params.trust):
            sys.exit(1)
