"""How a robot stands, in words and on its page."""
