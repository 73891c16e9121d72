"""Large numbers as people say them."""

from lightflyer.cli.output import duration, in_words, with_prefix


def test_large_numbers():
    assert [in_words(number) for number in (12.0, 2.5e6, 3e18)] == [
        "12", "2.5 million", "3e+06 trillion",
    ]  # fmt: skip
    assert [with_prefix(number, "B") for number in (12.0, 5.2e9)] == ["12 B", "5.2 GB"]
    assert [duration(time) for time in (7500.0, 90.0, 1e9)] == ["2 hours", "90 seconds", "32 years"]
