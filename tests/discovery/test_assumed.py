"""Limits of discovery stand in two records; every other number of its modules is of another kind, listed here."""

import ast
import re

import pytest

from jointwear.discovery import assumed
from jointwear.studies.world.assumptions import LIMITS, WRITTEN, moved, moves

#: Numbers of the modules that decide no verdict by themselves, by kind.
OTHERS = {
    "a grid, a range or a resolution that is searched": """
        base.DRIVE_ERRORS base.INERTIAL_ERRORS sound_fit.SOUND fallback.HALVINGS fallback.OF_LINKS fused_load.ENDS
        known_band.EACH_OCTAVE
        instruments.FREQUENCIES instruments.CUTOFFS instruments.LATE noise.HIGHEST_ORDER noise.HIGHEST_ORDER_DERIVED
        noise_spectrum.CELLS noise_spectrum.BANDS noise_spectrum.POINTS noise_spectrum.EDGES peak_torque.STEPS_OF_ONE
        peak_torque.STEPS_OF_MANY peak_torque.ZEROS problem.SMEAR recorded_in_time.SHARES refine.STARTS regimes.BINS
        shared_drives.SHARES saturated.START saturated.SHARP shared_delay.STEPS shared_delay.ASKED sound_links.BARRIER
        spectra.LONGEST
        spectra.SHORTEST spectra.SPAN spectra.SURROUNDINGS structure.KNOTS structure.KNOTS_OF_OTHERS
        structure.FEWEST_KNOTS structure.TIME_BIN structure.FRICTION_BIN structure.ORDERS residual_lines.FASTEST_CHIRP
        residual_lines.SLOW_SWEEP residual_lines.WIDEST_SWEEP residual_lines.COARSER
        in_its_place.SIZES effect_estimates.PERIODS
        gear_waves.CELLS gear_waves.SAMPLES gear_waves.NEARER gear_waves.FEWEST_WAVES gear_waves.STEPS noise.POINTS
        noise_spectrum.DAMPED references.BEYOND references.STARTS references.PARTS references.SHORTER refine.FIRST_STEP
        refine.SHORTER
        bursts.LOUDEST rocking.FREQUENCIES rocking.DAMPINGS rocking.DULL
        building_up.EXPONENTS building_up.STRIBECK building_up.CLOSE building_up.LEFT building_up.KNOTS
        building_up.PARTS
        instruments.LOWER curvature.STEP windings.STEP windings.ROUNDING effect_estimates.STEP
        effect_estimates.MORE_LOAD
    """,
    "the sign of a column by its definition": "problem.SENSE",
    "what a filter does": """
        reversals.RINGS
    """,
    "a bound on time": """
        building_up.SAMPLES leftovers.SPEEDS rocking.COARSE rocking.HINT
        base.MOST_FREE base.HALVINGS
        forward_search.MOST_REFUSED_ON_AXIS forward_search.RANKED forward_search.MOST_REFUSED
        estimation.REFINEMENTS noise.WIDE noise_spectrum.ROUNDS noise_spectrum.DRAWS peak_torque.DRAWS pipeline.READINGS
        saturated.DRAWN
        posterior.BEAM problem.POSES shared_drives.SAMPLES slow_noise.ROUNDS sound_links.STEPS sound_links.HALVINGS
        time_lines.MOST gear_waves.MOST base.ROUNDS noise_spectrum.ROUNDS_OF_LAGS refine.ROUNDS curvature.MOVES
        curvature.GAINED
    """,
    "the fewest samples of a statistic": """
        instruments.SHORT noise_spectrum.FEWEST_ROWS
        noise.ORDER_BESIDE_GAPS noise.LEFT_BY_ORDER slow_noise.FEW_SAMPLES
        noise_spectrum.FEWEST_OF_RECORD setting_up.FEWEST_SAMPLES regimes.LEAST_SAMPLES saturated.FEWEST_EACH
        shared_drives.FEWEST_STUCK shared_drives.FEWEST_EACH building_up.FEWEST_EACH spectra.FEWEST_PIECES
        noise.FEWEST_OF_MODEL noise.FEWEST_EACH residual_lines.FEWEST_OF_RECORD bursts.FEWEST_CHANGES
    """,
    "rounding, of numbers and of their digits in a log": """
        base.NOTHING base_parameters.SMALLEST candidates.STILL effect_estimates.ON_BOUND
        fast_waves.LEAST instruments.RIDGE peak_torque.STILL
        building_up.LEAST problem.ABSENT saturated.LEAST_NOISE shared_drives.RIDGE ridge_fit.RIDGE ridge_fit.FEW_DIGITS
        noise.SETTLE sound_links.ENOUGH sound_links.NOTHING structure.STILL
        base.BELOW base.STILL_BELOW references.FINEST references.DIGITS curvature.LEAST_SPREAD
        curvature.LARGEST_SPREAD largest_torque.LEAST_MOTION identifiability.RIDGE linear.FREE whitening.TOLD
        leftovers.LEAST_P
    """,
    "half, which is most of something, or no price at all": """
        changing_size.CHANGING decide.LIKELY left_out.UNTOLD standing_alone.MOST saturated.SEEN shaken.DERIVED
        final_model.ADDS_MORE shared_drives.UNEXPLAINED building_up.QUIET saturated.TWICE slow_noise.PRICE
        instruments.FEIGNED bursts.HIDES shared_delay.HELD
    """,
    "of a fit that is stored with its source": "calibration.COARSE calibration.LEAST_LEFT",
    "which rivals are told as tied with a name, and asked where it is not likely": """
        posterior.TIED_NATS posterior.TIED_SHARE
    """,
    "what a page, a table or a sentence says": """
        drawing.SAMPLES_SHOWN held_out.ABOVE_ALL findings.LONGEST_LIST findings.FEWEST_ALIKE findings.MOST_ALIKE
        largest_torque.NOT_BESIDE preflight.GAP preflight.MOVING restrictions.FEW_RECORDS restrictions.APART
        restrictions.TURNED
        reversals.SLOWEST reversals.MISSING experiment.DURATION experiment.RATE experiment.HARMONICS experiment.TRIALS
        experiment.SLOWEST experiment.EVERY experiment.LEAST_HARMONIC experiment.TRAVEL experiment.MOST_TRAVEL
        experiment.SEEN experiment.FASTER experiment.ALLOWED experiment.WARMING experiment.FREE largest_torque.ENDS
        leftovers.STRONG leftovers.NEAR page.NARROW page.HARDLY page.NO_PLACE preflight.SPEED smallest_sizes.STEP
        smallest_sizes.LARGEST written_robot.WIDTH
    """,
}
NUMBERS = (int, float)


@pytest.fixture(scope="module")
def folder(root):
    return root / "workflow/jointwear/discovery"


def numbers_of(path):
    """Return the public upper-case names of a module whose values hold numbers."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if not isinstance(node, ast.Assign):
            continue
        held = [c.value for c in ast.walk(node.value) if isinstance(c, ast.Constant)]
        if any(isinstance(v, NUMBERS) and not isinstance(v, bool) for v in held):
            names = (n.id for target in node.targets for n in ast.walk(target) if isinstance(n, ast.Name))
            yield from (f"{path.stem}.{name}" for name in names if re.fullmatch(r"[A-Z][A-Z_]*", name))


def test_no_limit_stands_outside_the_two_records(folder):
    """A new number that decides belongs into Settings or assumed.py, any other into the list of its kind above."""
    listed = [name for names in OTHERS.values() for name in names.split()]
    assert len(listed) == len(set(listed))
    found = {n for p in folder.rglob("*.py") if p.name not in ("assumed.py", "settings.py") for n in numbers_of(p)}
    assert found == set(listed)


#: What needs no name: none, one, a half, a double, an octave either way, mm or ms, a bound on what is computed. Counts.
PLAIN, COUNT, ROUND_OFF = (0.0, 0.5, 1.0, 2.0, 4.0, 1e3, 1e6), 10, 1e-6


def test_no_number_hides_in_a_function(folder):
    """A number has a name, or its reason in a comment beside it; lengths of drawings speak for themselves."""
    hidden = []
    for path in folder.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        lines, tree = text.splitlines(), ast.parse(text)
        told = {id(c) for f in ast.walk(tree) if isinstance(f, ast.JoinedStr) for c in ast.walk(f)}
        for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
            for node in ast.walk(function):
                if not isinstance(node, ast.Constant) or type(node.value) not in NUMBERS or id(node) in told:
                    continue
                size = abs(node.value)
                plain = size in PLAIN or size <= ROUND_OFF or (isinstance(size, int) and size <= COUNT)
                if not plain and not any("#" in line for line in lines[node.lineno - 2 : node.lineno]):
                    hidden.append(f"{path.name}:{node.lineno}: {node.value}")
    assert not [place for place in hidden if not place.startswith("drawing.py")]


def test_every_assumption_has_its_meaning_and_is_asked(folder):
    text = (folder / "assumed.py").read_text(encoding="utf-8")
    for name in LIMITS:
        assert re.search(rf"^#: .*\n{name} = ", text, re.MULTILINE), name
    modules = [p.read_text(encoding="utf-8") for p in folder.rglob("*.py")]
    # Taken over by name, a limit would keep its value when the record is moved.
    assert not any("from jointwear.discovery.assumed import" in module for module in modules)
    assert {name for module in modules for name in re.findall(r"\bassumed\.([A-Z_]+)\b", module)} >= set(LIMITS)


def test_every_assumption_moves_both_ways_and_comes_back():
    assert {name for name, _ in moves((0.7, 1.3))} == {*LIMITS, *WRITTEN}
    for (name, factor), (value, to) in moves((0.7, 1.3)).items():
        if name in WRITTEN:
            assert to - 1.0 == pytest.approx(factor * (value - 1.0))
            continue
        assert to == pytest.approx(factor * value)
        with pytest.raises(ArithmeticError):
            fail_with(name, to)
        assert getattr(assumed, name) == value


def fail_with(name, value):
    with moved(name, value):
        assert getattr(assumed, name) == value
        raise ArithmeticError
