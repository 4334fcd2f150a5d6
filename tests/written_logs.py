"""Logs of one joint, written line by line as loggers of plants write them."""

from jointwear.measurement.formats import layout_of, read_log

HEADER = ["time", "position_1", "torque_1"]


def one(path, **entry):
    """The samples of a log of one joint."""
    return next(iter(read_log(path, layout_of(entry, ["joint_1"]))))


def write(path, lines, encoding="utf-8"):
    path.write_bytes("\n".join(lines).encode(encoding))
    return path
