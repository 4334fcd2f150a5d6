"""Give one batch of the hidden-effect test to PySINDy, least squares and SysIdentPy.

Called with the folder of the batch and the file to write, by the Python of the peers' environment.
"""

import sys

from jointwear.running.script import reported
from jointwear.studies.challenge.peers import solve_batch_with_peers

if __name__ == "__main__":
    with reported():
        solve_batch_with_peers(sys.argv[1], sys.argv[2])
