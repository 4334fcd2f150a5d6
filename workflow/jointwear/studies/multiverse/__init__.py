"""Which reading of the paper's text reproduces its tables: hundreds of readings, many pose sets, one engine.

`dimensions` names what can be read in more than one way, `design` samples readings, `shared_torque`,
`shared_features` and `batched_model` do once what many readings share, `evaluation` runs readings on a pose
set, `scoring` compares them with the paper, `choice` corrects for having searched, `influence` says which
ambiguity matters, `lag_rule` explains the published way of locating wear, `naive` measures what sharing saves.
"""
