"""The paper, its text taken at its word, and the closest joint experiment, table by table."""
