"""``quatfilt evaluate pga-figs``: figures 1 to 4 of exact principal geodesic analysis."""

from importlib.metadata import version

from quatfilt import _validation
from quatfilt.cli import _output
from quatfilt.cli.evaluate._options import RESULTS, Data, Json, Output, Seeds, progress, say_written


def pga_figs(
    *,
    data: Data = None,
    seeds: Seeds = 5,
    output: Output = RESULTS,
    json: Json = False,
) -> None:
    """Measure principal geodesic analysis as its paper does: descents, a Gaussian, a root, and the joints of clips.

    Writes pga-figs.md, pga-figs.json and, with matplotlib, pga-figs.png.
    """
    # SciPy would slow down every verb.
    from quatfilt.evaluation import pga_figs as figs  # noqa: PLC0415
    from quatfilt.evaluation import pga_figs_page, pga_figs_picture  # noqa: PLC0415
    from quatfilt.evaluation._written import write  # noqa: PLC0415

    _validation.integer(seeds, "--seeds", at_least=1)
    with progress("fitting") as done:
        figures = figs.run(data, seeds=seeds, progress=done)
    command = f"quatfilt evaluate pga-figs{' --data DIR' if data else ''} --seeds {seeds}"
    run = pga_figs_page.Run(version("quatfilt"), command)
    numbers = figs.as_dict(figures, vars(run))
    written, trouble = write(
        output,
        pga_figs_page.STEM,
        page=pga_figs_page.markdown(figures, run),
        numbers=numbers,
        draw=lambda path: pga_figs_picture.draw(figures, path),
    )
    if json:
        _output.print_json(numbers)
        return
    _output.say("Mean angle that k geodesics leave, degrees")
    _output.print_table(
        ("samples", *(f"k = {k}" for k in range(1, figs.COMPONENTS + 1))),
        [
            (name, *(_output.number(value, 4) for value in values))
            for name, values in (
                *((entry["what"], entry["residuals"]) for entry in numbers["low"]),
                ("Gaussian on S³ (Fig. 3), first seed", numbers["gaussian"]["residuals"][0]),
                (f"root of {numbers['root']['clip']} (Fig. 4)", numbers["root"]["residuals"]),
            )
        ],
    )
    say_written(written, trouble)


__all__ = ["pga_figs"]
