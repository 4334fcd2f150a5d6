"""Compute a crate again and compare: `comparison` looks at two files, `recomputation` at a whole run."""
