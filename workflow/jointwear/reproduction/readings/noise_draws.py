"""Is the measurement noise of position, velocity and acceleration one draw or three?"""

STAGE = "simulation"
PAPER = "Equation (9): y = C x + [1, 1/dt, 1/dt^2] nu; below equation (2): nu is in R^3."
DEFAULT = "one_draw"


def one_draw(draw):
    """One draw scaled by 1, 1/dt and 1/dt^2, as equation (9) is printed."""
    noise = draw()
    return noise, noise, noise


def three_draws(draw):
    """Three independent draws, as nu in R^3 below equation (2) says."""
    return draw(), draw(), draw()
