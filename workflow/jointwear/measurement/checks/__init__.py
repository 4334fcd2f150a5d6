"""Does a recording belong to its robot file, and can its numbers be: what is refused, and what is read instead."""
