"""Axes, distributions and samples: the values that they give, and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.stats import kstest, norm, qmc

from sim.study.axes import LONGEST_AXIS, Axis, Distribution, Samples, checked, is_number, is_whole

PATH = "published.impedance.damping"


def axis(**given):
    return Axis.model_validate(given)


class TestAxis:
    def test_a_list_stays_as_written(self):
        assert Axis.model_validate([3.0, 1.0, 2]).listed() == (3.0, 1.0, 2)

    def test_a_range_by_step_has_both_ends(self):
        assert axis(**{"from": 0.0, "to": 15.0, "step": 1.5}).listed() == tuple(1.5 * place for place in range(11))

    def test_a_range_by_step_ends_before_an_end_that_no_step_reaches(self):
        assert axis(**{"from": 0.0, "to": 1.0, "step": 0.4}).listed() == (0.0, 0.4, 0.8)

    def test_decimals_are_what_a_person_would_write(self):
        assert axis(**{"from": 0.1, "to": 0.7, "step": 0.2}).listed() == (0.1, 0.3, 0.5, 0.7)
        assert axis(**{"from": 0.0, "to": 0.3, "step": 0.1}).listed() == (0.0, 0.1, 0.2, 0.3)

    def test_a_range_by_count(self):
        assert axis(**{"from": 1.0, "to": 2.0, "count": 3}).listed() == (1.0, 1.5, 2.0)
        assert axis(**{"from": 1.0, "to": 1.0, "count": 1}).listed() == (1.0,)

    def test_a_logarithmic_range(self):
        given = {"from": 0.01, "to": 10.0, "count": 4, "spacing": "logarithmic"}
        assert axis(**given).listed() == (0.01, 0.1, 1.0, 10.0)

    @pytest.mark.parametrize(
        ("given", "words"),
        [
            ([], "list of values is empty"),
            ({"from": 5.0, "to": 1.0, "step": 1.0}, "range is empty"),
            ({"from": 1.0, "to": 5.0, "step": 0.0}, "range is empty"),
            ({"from": 1.0, "to": 5.0, "step": -1.0}, "range is empty"),
            ({"from": 1.0, "to": 5.0, "count": 0}, "range is empty"),
            ({"from": 0.0, "to": 1.0, "step": 1e-9}, str(LONGEST_AXIS)),
            ({"from": 0.0, "to": 1e300, "step": 1e-300}, str(LONGEST_AXIS)),
            ({"from": 1.0, "to": 5.0}, "step or count"),
            ({"from": 1.0, "to": 5.0, "step": 1.0, "count": 5}, "step or count"),
            ({"values": [1.0], "step": 1.0}, "not both"),
            ({"from": 0.0, "to": 5.0, "count": 5, "spacing": "logarithmic"}, "above 0"),
            ({"from": 1.0, "to": 5.0, "step": 1.0, "spacing": "logarithmic"}, "count, not a step"),
            ({"from": float("nan"), "to": 5.0, "count": 5}, "finite"),
            (5.0, "step or count"),
            ({"from": 1.0, "too": 5.0, "step": 1.0}, "Extra inputs"),
        ],
    )
    def test_refuses(self, given, words):
        with pytest.raises(ValidationError, match=words):
            Axis.model_validate(given)


class TestDistribution:
    fractions = np.linspace(0.0, 1.0, 5)

    def test_uniform(self):
        uniform = Distribution.model_validate({"from": 2.0, "to": 4.0})
        np.testing.assert_allclose(uniform.quantiles(self.fractions), [2.0, 2.5, 3.0, 3.5, 4.0])

    def test_logarithmic(self):
        spread = Distribution.model_validate({"from": 0.01, "to": 100.0, "spacing": "logarithmic"})
        np.testing.assert_allclose(spread.quantiles(self.fractions), [0.01, 0.1, 1.0, 10.0, 100.0])

    def test_normal(self):
        normal = Distribution(mean=2.0, deviation=0.5)
        np.testing.assert_allclose(normal.quantiles(np.asarray(norm.cdf([-1.0, 0.0, 2.0]))), [1.5, 2.0, 3.0])
        assert np.isfinite(normal.quantiles(self.fractions)).all()

    def test_normal_cut(self):
        cut = Distribution.model_validate({"mean": 0.0, "deviation": 1.0, "from": -0.5, "to": 2.0})
        drawn = cut.quantiles(np.linspace(0.0, 1.0, 1001))
        assert drawn.min() >= -0.5
        assert drawn.max() <= 2.0
        half = Distribution.model_validate({"mean": 0.0, "deviation": 1.0, "from": 0.0})
        assert half.quantiles(np.array([0.5]))[0] == pytest.approx(norm.ppf(0.75))

    @pytest.mark.parametrize(
        ("given", "words"),
        [
            ({"mean": 1.0}, "mean and deviation"),
            ({"deviation": 1.0}, "mean and deviation"),
            ({"mean": 1.0, "deviation": 0.0}, "greater than 0"),
            ({"from": 1.0}, "from and to"),
            ({"from": 2.0, "to": 2.0}, "empty"),
            ({"mean": 1.0, "deviation": 1.0, "from": 3.0, "to": 2.0}, "empty"),
            ({"mean": 1.0, "deviation": 1.0, "spacing": "logarithmic"}, "only a uniform"),
            ({"from": -1.0, "to": 2.0, "spacing": "logarithmic"}, "above 0"),
        ],
    )
    def test_refuses(self, given, words):
        with pytest.raises(ValidationError, match=words):
            Distribution.model_validate(given)


class TestSamples:
    over = {"target.mass": {"from": 1.0, "to": 2.0}, "target.initial_spin": {"mean": 1.0, "deviation": 0.1}}  # noqa: RUF012

    def samples(self, count, method):
        return Samples.model_validate({"count": count, "method": method, "over": self.over})

    @pytest.mark.parametrize("method", ["random", "latin_hypercube", "sobol"])
    def test_points_follow_their_distributions_and_the_generator(self, method):
        samples = self.samples(256, method)
        points = samples.points(np.random.default_rng(3))
        assert points.shape == (256, 2)
        assert kstest(points[:, 0], "uniform", (1.0, 1.0)).pvalue > 0.01
        assert kstest(points[:, 1], "norm", (1.0, 0.1)).pvalue > 0.01
        np.testing.assert_array_equal(points, samples.points(np.random.default_rng(3)))
        assert (points != samples.points(np.random.default_rng(4))).any()

    def test_a_latin_hypercube_has_one_point_in_each_slice(self):
        points = self.samples(40, "latin_hypercube").points(np.random.default_rng(0))
        assert sorted(np.floor(40 * (points[:, 0] - 1.0))) == list(range(40))

    def test_sobol_fills_more_evenly_than_chance(self):
        spread = {
            method: qmc.discrepancy(self.samples(256, method).points(np.random.default_rng(0))[:, :1] - 1.0)
            for method in ("sobol", "random")
        }
        assert spread["sobol"] < 0.1 * spread["random"]

    @pytest.mark.parametrize(
        ("count", "method", "words"),
        [(0, "random", "greater than or equal to 1"), (100, "sobol", "64 or 128"), (4, "sobl", "latin_hypercube")],
    )
    def test_refuses(self, count, method, words):
        with pytest.raises(ValidationError, match=words):
            self.samples(count, method)

    def test_of_nothing_is_refused(self):
        with pytest.raises(ValidationError, match="at least 1 item"):
            Samples.model_validate({"count": 4, "over": {}})


class TestValues:
    def test_take_the_type_of_their_parameter(self):
        assert isinstance(checked(PATH, 3, "grid"), float)
        assert isinstance(checked("simulation.solver_iterations", 30.0, "grid"), int)
        assert checked("contact.corner", "radial", "grid") == "radial"
        assert type(checked("contact.corner", "radial", "grid")) is str

    @pytest.mark.parametrize(
        ("path", "value", "words"),
        [
            (PATH, -1.0, ["grid.published.impedance.damping", "-1.0", "greater than or equal to 0", "[N s/m]"]),
            (PATH, True, ["valid number"]),
            (PATH, float("inf"), ["finite"]),
            ("simulation.solver_iterations", 30.5, ["30.5", "integer"]),
            ("contact.corner", "round", ["round", "'face' or 'radial'"]),
        ],
    )
    def test_out_of_bounds_name_parameter_value_and_bound(self, path, value, words):
        with pytest.raises(ValueError, match="grid") as refused:
            checked(path, value, "grid")
        for word in words:
            assert word in str(refused.value)

    def test_kinds_of_parameters(self):
        assert is_number(PATH)
        assert is_whole("simulation.seed")
        assert not is_number("contact.corner")
        assert not is_whole("contact.corner")
