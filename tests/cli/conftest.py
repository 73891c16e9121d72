import pytest

from lightflyer import cli


@pytest.fixture
def run(capsys):
    """Run a command in this process; returns exit code, output and errors."""

    def command(*arguments):
        code = 0
        try:
            cli.main([str(argument) for argument in arguments])
        except SystemExit as error:
            code = error.code or 0
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return command
