"""A run of the workflow as a Workflow Run RO-Crate: `records` reads what Snakemake kept, `writing` packs it."""
