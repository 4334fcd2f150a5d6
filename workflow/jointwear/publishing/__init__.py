"""Publishing: figures, the report, the site, the crate, and its verification."""
