"""Studies: long experiments on the product; they import it, never the other way round."""
