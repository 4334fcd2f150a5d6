"""Running: what Snakemake needs at every call: configuration, scripts, imported modules, the stale lock."""
