"""What is no alarm of wear but must be told."""
