"""A scan with kept sums of products says what every candidate says by itself."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery.estimates.scan import gain_about_one, possible, scan
from jointwear.discovery.linear import Fit, Term, gain, posterior_mean
from jointwear.discovery.problem.candidates import build_dictionary, of_bases, term_of
from jointwear.discovery.problem.products import Products
from jointwear.effects import get_effect

SAMPLES, COLUMNS = 200, 5


@pytest.fixture
def rng():
    return np.random.default_rng(3)


def fit_of(rng, targets, *sizes):
    """Return a fit of terms with so many columns on axis 1; axis 0 has a term of its own."""
    terms = [Term(f"of {k}", {1: rng.standard_normal((SAMPLES, k))}, np.full(k, 2.0)) for k in sizes]
    return Fit(targets, [Term("other", {0: rng.standard_normal((SAMPLES, 2))}, np.ones(2)), *terms])


def test_products_are_those_of_the_fit_whatever_was_asked_before(rng):
    columns, targets = rng.standard_normal((SAMPLES, COLUMNS)), list(rng.standard_normal((2, SAMPLES)))
    products = Products(1, columns)
    for sizes in [(1,), (3, 2), (), (1, 1)]:
        fit = fit_of(rng, targets, *sizes)
        for found, wanted in zip(products.projected(fit), fit.projected({1: columns}), strict=True):
            assert found == pytest.approx(wanted, rel=1e-10, abs=1e-10)
    assert products.squares == pytest.approx(np.sum(columns**2, axis=0))


def test_a_term_that_lies_where_another_lay_is_not_taken_for_it(rng):
    columns, targets = rng.standard_normal((SAMPLES, COLUMNS)), list(rng.standard_normal((2, SAMPLES)))
    products = Products(1, columns)
    block = rng.standard_normal((SAMPLES, 1))
    products.projected(Fit(targets, [Term("one", {1: block}, np.ones(1))]))
    place, others = id(block), []
    del block
    while not others or id(others[-1]) != place:
        others.append(rng.standard_normal((SAMPLES, 1)))
        assert len(others) < 1000, "no array took the place of another"
    fit = Fit(targets, [Term("two", {1: others[-1]}, np.ones(1))])
    assert products.projected(fit)[1] == pytest.approx(fit.projected({1: columns})[1], rel=1e-10)


def test_products_ask_for_no_sample_twice(rng):
    columns, targets = rng.standard_normal((SAMPLES, COLUMNS)), list(rng.standard_normal((2, SAMPLES)))
    products, fit = Products(1, columns), fit_of(rng, targets, 2)
    first = products.projected(fit)
    columns[:] = np.nan
    assert np.array_equal(first[0], products.projected(fit)[0])


@pytest.mark.parametrize("count", [1, 2, 4])
def test_groups_gain_what_each_of_them_gains(rng, count):
    x, b, std = rng.standard_normal((7, 30, count)), rng.standard_normal((7, count)), rng.uniform(0.1, 3.0, (7, count))
    gram = x.transpose(0, 2, 1) @ x
    gram[3] = np.diag([-1e3, *np.zeros(count - 1)])
    together, means = gain(b, gram, std), posterior_mean(b, gram, std)
    assert together[3] == -np.inf
    for i in range(7):
        assert together[i] == pytest.approx(gain(b[i], gram[i], std[i]), rel=1e-12)
        assert means[i] == pytest.approx(posterior_mean(b[i], gram[i], std[i]), rel=1e-12)
    for i in (0, 6):
        # Of the textbook: the log of the marginal likelihood over that without the columns.
        precision = gram[i] + np.diag(std[i] ** -2.0)
        wanted = 0.5 * b[i] @ np.linalg.inv(precision) @ b[i]
        wanted -= 0.5 * np.log(np.linalg.det(precision) * np.prod(std[i] ** 2))
        assert together[i] == pytest.approx(wanted, rel=1e-9)
        assert means[i] == pytest.approx(np.linalg.inv(precision) @ b[i], rel=1e-9)


def test_a_scan_says_what_each_candidate_gains(white):
    """Beside one named effect; of a family with one point the evidence is its gain, less the price of the library."""
    dictionary = build_dictionary(white)
    named = next(s for s in scan(white, dictionary, white.fit()) if s.candidate.effect == "joint_flexibility")
    fit = white.fit([term_of(white, named.candidate)])
    points = {}
    for axis, matrix in dictionary.matrix.items():
        for candidate, where, std in dictionary.entries[axis]:
            b, gram = fit.gram({axis: matrix[:, where]})
            if possible(get_effect(candidate.effect), candidate.nonlinear, posterior_mean(b, gram, std)):
                points.setdefault(candidate.key, []).append(gain(b, gram, std))
    alone = len(points)
    for candidates, matrices in dictionary.spreading:
        for k, one in enumerate(candidates):
            sums = fit.gram({axis: x[:, [k]] for axis, x in matrices.items()})
            points.setdefault(one.key, []).append(gain_about_one(white, *sums, white.problem.settings.off_scale))
    found = {s.candidate.key: s for s in scan(white, dictionary, fit)}
    assert points.keys() <= found.keys()
    assert len(points) > alone > 20
    price = np.log(len(found))
    for key, values in points.items():
        wanted = np.logaddexp.reduce(values) - np.log(len(values)) - price
        assert found[key].evidence == pytest.approx(wanted, rel=1e-6, abs=1e-6)
    chosen = set(list(points)[::5])
    for one in scan(white, dictionary, fit, chosen):
        assert one.candidate.key in chosen
        assert one.evidence == pytest.approx(found[one.candidate.key].evidence + price, rel=1e-6, abs=1e-6)


def test_a_fit_that_takes_over_sums_of_products_is_the_whole_fit(rng):
    targets = list(rng.standard_normal((2, SAMPLES)))
    whole = fit_of(rng, targets, 3, 2)
    taken = Fit(targets, whole.terms, Fit(targets, whole.terms[:2]))
    for name in ("normal", "right", "theta", "covariance", "evidence"):
        np.testing.assert_allclose(getattr(taken, name), getattr(whole, name), rtol=1e-10, atol=1e-12)


def test_bases_asked_together_say_what_each_says_alone(white):
    fit = white.fit()
    bases = white.bases(1)
    empty = replace(bases[0], columns=np.zeros_like(bases[0].columns))
    found = list(of_bases(white, fit, 1, [empty, *bases]))
    assert [basis.argument for basis, _ in found] == [basis.argument for basis in bases]
    for basis, seen in found:
        columns = white.columns(1, basis.columns)[:, seen.good]
        b, gram = fit.gram({1: columns})
        np.testing.assert_allclose(seen.b, b, rtol=1e-9, atol=1e-9 * np.abs(b).max())
        np.testing.assert_allclose(seen.gram, gram, rtol=1e-9, atol=1e-9 * np.abs(gram).max())
        np.testing.assert_allclose(seen.full, columns.T @ columns, rtol=1e-12, atol=1e-9)
