"""Studies: their cells, in order and with their seeds, and what cannot be a study."""

from __future__ import annotations

import json

import pytest

from sim.config import Engine, value_at
from sim.errors import ConfigError
from sim.reproduction.experiments import tables_study
from sim.reproduction.published import published_study
from sim.study.design import Study, configured, flattened, read_study, study_of

MASS, DAMPING, SPIN = "published.impedance.mass", "published.impedance.damping", "target.initial_spin"
GRID = {MASS: [0.05, 0.1], DAMPING: [0.0, 1.5, 3.0]}
SAMPLES = {"count": 4, "method": "random", "over": {SPIN: {"from": 0.5, "to": 2.0}}}


class TestCells:
    def test_of_a_grid_change_the_last_axis_fastest(self):
        study = study_of({"grid": GRID})
        values = [(cell.values[MASS], cell.values[DAMPING]) for cell in study.cells()]
        assert values == [(0.05, 0.0), (0.05, 1.5), (0.05, 3.0), (0.1, 0.0), (0.1, 1.5), (0.1, 3.0)]
        assert study.count == 6
        assert study.shape == (2, 3, 1)
        assert study.varied == (MASS, DAMPING)

    def test_of_samples_meet_every_combination_of_the_grid(self):
        study = study_of({"grid": GRID, "samples": SAMPLES})
        spins = [cell.values[SPIN] for cell in study.cells()]
        assert study.count == 24
        assert len(set(spins)) == 4
        assert spins[:4] == spins[4:8] == spins[20:]

    def test_can_be_had_one_by_one(self):
        study = study_of({"grid": GRID, "samples": SAMPLES})
        assert study.cell(17) == list(study.cells())[17]
        assert [cell.index for cell in study.cells()] == list(range(24))
        for index in (-1, 24):
            with pytest.raises(IndexError, match="24 cells"):
                study.cell(index)

    def test_follow_from_the_study_alone(self):
        given = {"grid": GRID, "samples": SAMPLES, "seed": 5}
        assert list(study_of(given).cells()) == list(study_of(json.loads(json.dumps(given))).cells())

    def test_have_seeds_of_their_own_that_follow_from_the_studys(self):
        seeds = [[cell.seed for cell in study_of({"grid": GRID, "seed": seed}).cells()] for seed in (0, 1)]
        assert len({*seeds[0], *seeds[1]}) == 12
        wider = study_of({"grid": {MASS: [0.05, 0.1], DAMPING: [0.0, 1.5, 3.0, 4.5]}})
        assert [wider.cell(index).seed for index in range(6)] == seeds[0]

    def test_of_another_seed_draw_other_points(self):
        drawn = [
            [cell.values[SPIN] for cell in study_of({"samples": SAMPLES, "seed": seed}).cells()] for seed in (0, 1)
        ]
        assert not set(drawn[0]) & set(drawn[1])

    def test_a_varied_seed_is_the_cells(self):
        study = study_of({"grid": {"simulation.seed": [7, 8]}})
        assert [cell.seed for cell in study.cells()] == [7, 8]
        assert configured(study.base, study.cell(1)).simulation.seed == 8

    def test_a_million_cost_nothing_until_they_are_wanted(self):
        axis = {"from": 0.1, "to": 1.0, "count": 1000}
        study = study_of({"grid": {MASS: axis, DAMPING: axis, SPIN: axis}})
        assert study.count == 10**9
        assert study.cell(10**9 - 1).values == {MASS: 1.0, DAMPING: 1.0, SPIN: 1.0}


class TestConfiguration:
    def test_of_a_cell_has_base_changes_and_values(self):
        study = study_of({"configuration": "as_printed", "changes": {"contact.friction": 0.2}, "grid": GRID})
        cell = study.cell(4)
        config = configured(study.base, cell)
        assert config.contact.friction == 0.2
        assert config.target.mass == 2.35
        assert {path: value_at(config, path) for path in GRID} == cell.values
        assert config.simulation.seed == cell.seed

    def test_values_that_do_not_fit_together_are_the_cells_own_failure(self):
        study = study_of({"grid": {"simulation.time_step": [1e-3, 3e-4]}})
        with pytest.raises(ConfigError, match="does not divide"):
            configured(study.base, study.cell(1))


class TestAListOfPoints:
    """No axis, as a table's column holds one value; all cells may share one."""

    @pytest.mark.parametrize(
        "varied",
        [
            {"grid": {"target.vertices": [[[0, 0], [0.2, 0], [0, 0.1]]]}},
            {"samples": {"count": 2, "over": {"target.vertices": {"from": 0.1, "to": 0.2}}}},
        ],
    )
    def test_cannot_vary_and_says_why(self, varied):
        with pytest.raises(ConfigError, match=r"target\.vertices cannot vary within a study: it is a list of points"):
            study_of(varied)

    def test_is_shared_by_all_cells(self):
        points = [[0, 0], [0.2, 0], [0, 0.1]]
        study = study_of({"changes": {"target.vertices": points}, "grid": GRID})
        assert configured(study.base, study.cell(1)).target.vertices == ((0, 0), (0.2, 0), (0, 0.1))
        assert study_of(json.loads(json.dumps(study.definition()))) == study


class TestDefinition:
    def test_nested_and_flat_paths_are_the_same(self):
        nested = {"grid": {"published": {"impedance": {"mass": [0.05, 0.1], "damping": [0.0, 1.5, 3.0]}}}}
        assert study_of(nested) == study_of({"grid": GRID})

    def test_flattened_keeps_what_describes_an_axis(self):
        axis = {"from": 0.0, "to": 1.0, "step": 0.5}
        assert flattened({"published": {"impedance": {"mass": axis}}, DAMPING: [1.0]}) == {MASS: axis, DAMPING: [1.0]}

    def test_comes_back_from_its_own_definition(self):
        study = study_of(
            {
                "name": "all",
                "changes": {"contact.friction": 0.2},
                "direct": True,
                "seed": 9,
                "grid": {MASS: {"from": 0.1, "to": 1.0, "count": 3, "spacing": "logarithmic"}, DAMPING: [1.0]},
                "samples": {"count": 2, "over": {SPIN: {"mean": 1.0, "deviation": 0.1, "from": 0.5}}},
            }
        )
        definition = study.definition()
        assert study_of(json.loads(json.dumps(definition))) == study
        assert definition["samples"]["over"][SPIN]["from"] == 0.5

    def test_toml_and_json_files(self, tmp_path):
        toml = tmp_path / "soft.toml"
        toml.write_text(
            "[changes]\ncontact.friction = 0.2\n[grid]\n"
            "published.impedance.damping = { from = 0.0, to = 3.0, step = 1.5 }\n"
            '[samples]\ncount = 4\nmethod = "sobol"\n[samples.over]\ntarget.initial_spin = { from = 0.5, to = 2.0 }\n'
        )
        study = read_study(toml)
        assert study.name == "soft"
        assert study.count == 12
        other = tmp_path / "soft.json"
        other.write_text(json.dumps(study.definition()))
        assert read_study(other) == study

    @pytest.mark.parametrize(
        ("name", "text", "words"),
        [("a.toml", "[grid", "does not parse"), ("a.json", "[]", "holds no table"), ("a.toml", None, "No such file")],
    )
    def test_files_that_cannot_be_read(self, tmp_path, name, text, words):
        path = tmp_path / name
        if text is not None:
            path.write_text(text)
        with pytest.raises(ConfigError, match=f"study file.*{name}.*{words}"):
            read_study(path)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, ["varies nothing"]),
        (
            {"grid": {"published.impedance.dampin": [1.0]}},
            ["grid.published.impedance.dampin", "mean published.impedance.damping?"],
        ),
        (
            {"samples": {**SAMPLES, "over": {"target.mas": {"from": 1.0, "to": 2.0}}}},
            ["samples.over.target.mas", "target.mass?"],
        ),
        ({"grid": GRID, "changes": {"contact.frictio": 1.0}}, ["changes.contact.frictio", "contact.friction?"]),
        ({"grid": {MASS: [0.1, 0.0]}}, ["grid.published.impedance.mass = 0.0", "greater than 0", "[kg]"]),
        ({"grid": {MASS: [0.1, 0.2, 0.1]}}, ["grid.published.impedance.mass", "0.1", "twice"]),
        (
            {"grid": {MASS: {"from": 2.0, "to": 1.0, "step": 0.1}}},
            ["grid.published.impedance.mass", "'from': 2.0", "empty"],
        ),
        ({"grid": {MASS: []}}, ["grid.published.impedance.mass", "empty"]),
        ({"grid": GRID, "changes": {MASS: 1.0}}, [MASS, "varied", "1.0"]),
        ({"grid": GRID, "changes": {"simulation.seed": 1}}, ["simulation.seed", "cannot be set"]),
        ({"grid": {SPIN: [1.0]}, "samples": SAMPLES}, [SPIN, "cannot be sampled as well"]),
        (
            {"samples": {**SAMPLES, "over": {"simulation.seed": {"from": 1.0, "to": 2.0}}}},
            ["simulation.seed", "put it on the grid"],
        ),
        (
            {"samples": {"count": 99, "over": {MASS: {"mean": 0.1, "deviation": 0.1}}}},
            ["samples.over.published.impedance.mass", "greater than 0", "[kg]", "cut it"],
        ),
        ({"samples": {**SAMPLES, "count": 0}}, ["samples.count = 0", "greater than or equal to 1"]),
        ({"grid": GRID, "seed": -1}, ["seed = -1", "greater than or equal to 0"]),
        ({"gird": GRID}, ["gird", "did you mean grid?"]),
        (
            {"grid": {MASS: {"from": 1.0, "to": 2.0, "stepp": 1.0}}},
            ["grid.published.impedance.mass.stepp", "did you mean step?"],
        ),
        ({"grid": GRID, "configuration": "publishd"}, ["publishd", "published_figures"]),
        ({"grid": GRID, "changes": {"target.initial_y": 0.1}}, ["target.initial_y", "overlaps"]),
        ({"grid": GRID, "changes": {"target.mass": -1.0}}, ["target.mass = -1.0", "greater than 0", "[kg]"]),
    ],
)
def test_what_cannot_be_a_study_names_field_value_and_bound(given, words):
    with pytest.raises(ConfigError) as refused:
        study_of(given)
    for word in words:
        assert word in str(refused.value)


def test_a_study_is_frozen():
    study = study_of({"grid": GRID})
    assert isinstance(study, Study)
    with pytest.raises(ValueError, match="frozen"):
        study.seed = 3  # type: ignore[misc]


class TestEngine:
    def test_is_the_reduced_plant_and_said_in_the_definition(self):
        study = study_of({"grid": GRID})
        assert study.base.simulation.engine is Engine.REDUCED
        assert study.definition()["changes"] == {"simulation.engine": "reduced"}

    @pytest.mark.parametrize("changes", [{"simulation.engine": "pymunk"}, {"simulation": {"engine": "pymunk"}}])
    def test_that_is_named_flies(self, changes):
        assert study_of({"grid": GRID, "changes": changes}).base.simulation.engine is Engine.PYMUNK

    def test_may_be_what_varies(self):
        study = study_of({"grid": {"simulation.engine": ["pymunk", "reduced"]}})
        assert [configured(study.base, cell).simulation.engine for cell in study.cells()] == list(Engine)

    def test_of_the_papers_tables_is_the_one_that_is_written_about(self):
        assert published_study().base.simulation.engine is Engine.PYMUNK
        assert tables_study("as_printed", 5).base.simulation.engine is Engine.PYMUNK

    def test_of_a_study_stored_without_one_is_that_of_its_configuration(self):
        assert study_of({"grid": GRID}, stored=True).base.simulation.engine is Engine.PYMUNK

    def test_refuses_what_only_pymunk_reads(self):
        with pytest.raises(ConfigError, match=r"solver_iterations = 40 is read by simulation\.engine = 'pymunk' only"):
            study_of({"grid": GRID, "changes": {"simulation.solver_iterations": 40}})
