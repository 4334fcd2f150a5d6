"""Robots: robot files, URDF, rigid-body dynamics, inertial parameters, and the tasks that they carry out."""
