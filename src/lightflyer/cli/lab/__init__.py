"""``lightflyer lab``: numbers with intervals from raw measurements."""

import cyclopts

from lightflyer.lab.commands import measurements

app = cyclopts.App(
    name="lab", help="Reduce raw measurements to numbers with intervals, figures and records."
)
for _name, _about in measurements().items():
    app.command(f"lightflyer.cli.lab.measure:{_name}", name=_name, help=_about)
app.command(
    "lightflyer.cli.lab.summary:summary_command",
    name="summary",
    help="The numbers of many records in one table.",
)
app.command(
    "lightflyer.cli.lab.example:example_command",
    name="example",
    help="Write synthetic raw files to try a command with.",
)
