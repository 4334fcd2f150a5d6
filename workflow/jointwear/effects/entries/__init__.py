"""One file an effect; each defines EFFECT."""

# Its modules are found by listing the folder, so a script that imports it depends on all of them.
WHOLE_PACKAGE = True
