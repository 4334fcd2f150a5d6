"""Files: netCDF storage, YAML and JSON documents checked against their schemas, provenance, and errors that help."""
