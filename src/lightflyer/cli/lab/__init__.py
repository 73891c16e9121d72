"""``lightflyer lab``: numbers with intervals from raw measurements, one module per command."""

import cyclopts

app = cyclopts.App(
    name="lab", help="Reduce raw measurements to numbers with intervals, figures and records."
)
app.command(
    "lightflyer.cli.lab.levitation:levitation_command",
    name="levitation",
    help="Optimal pressure and minimum irradiance from levitation points.",
)
app.command(
    "lightflyer.cli.lab.thermography:thermography_command",
    name="thermography",
    help="Emissivity from apparent temperatures, absorptivity from a light meter.",
)
app.command(
    "lightflyer.cli.lab.ftir:ftir_command",
    name="ftir",
    help="Emissivity, or its upper bound, from infrared spectra.",
)
app.command(
    "lightflyer.cli.lab.optics:optics_command",
    name="optics",
    help="Thickness, porosity and optical constants of a film from its spectra.",
)
app.command(
    "lightflyer.cli.lab.roughness:roughness_command",
    name="roughness",
    help="Roughness of surfaces from height maps, without the particles on them.",
)
app.command(
    "lightflyer.cli.lab.tac:tac_command",
    name="tac",
    help="Accommodation coefficient from a heater's power against pressure.",
)
app.command(
    "lightflyer.cli.lab.force:force_command",
    name="force",
    help="Force on a heated vane over pressure, beside the kinetic equation.",
)
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
