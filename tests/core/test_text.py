import pytest

from lightflyer.core.text import files_read, in_toml, read_text, rounded


def test_files_are_noted_within_their_block_alone(write):
    one, two, three = (write(name, name) for name in ("one.toml", "two.toml", "three.toml"))
    with files_read() as outer:
        read_text(one)
        with files_read() as inner:
            read_text(two)
        read_text(one)
    read_text(three)  # a notebook's or a server's: nobody notes it
    assert (outer, inner) == ([one, one], [two])


def test_values_as_toml():
    assert in_toml({"at_most": ["400 K", True]}) == '{ at_most = ["400 K", true] }'


@pytest.mark.parametrize(
    ("value", "told"), [(570.4, "570"), (0.04449, "0.044"), (1.3e4, "13000"), (99.7, "100")]
)
def test_two_digits_need_no_power_of_ten(value, told):
    assert rounded(value) == told
