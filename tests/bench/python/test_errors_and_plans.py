# SPDX-License-Identifier: GPL-3.0-or-later
import pytest
import todbench as tb


def test_an_error_has_code_key_and_reason():
    with pytest.raises(tb.Error) as raised:
        tb.Plan("demo").replaced({"target.delta_t_k": [0]})

    assert raised.value.code == "invalid_input"
    assert raised.value.key == "target.delta_t_k"
    assert raised.value.reason in str(raised.value)


def test_an_unknown_key_is_named():
    with pytest.raises(tb.Error) as raised:
        tb.Plan("demo").replaced({"target.delta": 1})

    assert (raised.value.code, raised.value.key) == ("invalid_input", "target.delta")


def test_an_unknown_word_is_an_error_with_the_known_ones():
    with pytest.raises(tb.Error, match="'size', 'acuity', found 'log'"):
        tb.fit_psychometric([1], [1], [2], form="log")


def test_an_absent_camera_is_not_found():
    with pytest.raises(tb.Error) as raised:
        tb.open_camera("file:/no/such/recording")

    assert raised.value.code == "not_found"


def test_a_plan_reads_what_it_wrote(small_plan, tmp_path):
    small_plan.write(tmp_path / "plan.toml")

    assert tb.Plan(str(tmp_path / "plan.toml")) == small_plan


def test_values_of_keys_survive_exactly(small_plan):
    changed = small_plan.replaced({"seed": 7, "target.delta_t_k": [1 / 3, 2], "measures.noise": True})

    assert changed["target.delta_t_k"] == [1 / 3, 2]
    assert (changed["seed"], changed["measures.noise"]) == (7, True)
    assert small_plan["seed"] == 3


def test_every_key_of_sections_that_are_not_repeated_can_be_read(small_plan):
    readable = 0
    for path in tb.plan_keys():
        try:
            small_plan[path]
            readable += 1
        except tb.Error as error:
            assert "repeated" in str(error)
    assert readable > 100


def test_built_in_descriptions_load():
    assert "hvs-1" in tb.built_in("observer")
    assert tb.load_sensor("sc2000").width == 320
    assert len(tb.load_plate("tcat-a").triangles) > 10
