"""``quatfilt evaluate reconstruction-tables``: tables 1 and 2 and figure 3 of Mousas et al."""

from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import typer

from quatfilt import _validation
from quatfilt.cli import _output
from quatfilt.cli.evaluate._options import RESULTS, Json, Output, progress, say_written


def reconstruction_tables(
    *,
    data: Annotated[
        Path,
        typer.Option(
            metavar="DIR", help="Folder of CMU's recordings, a folder for each person.", show_default=False
        ),
    ],
    models: Annotated[
        str | None, typer.Option(metavar="NAME,…", help="Which local models. [default: all]")
    ] = None,
    output: Output = RESULTS,
    json: Json = False,
) -> None:
    """Reconstruct whole bodies from a few joints of people who are not in the database, with each local model.

    Writes reconstruction-tables.md, reconstruction-tables.json and, with matplotlib, reconstruction-tables.png.
    """
    # SciPy would slow down every verb.
    from quatfilt.evaluation import reconstruction_tables as tables  # noqa: PLC0415
    from quatfilt.evaluation import reconstruction_tables_page as page  # noqa: PLC0415
    from quatfilt.evaluation import reconstruction_tables_picture as picture  # noqa: PLC0415
    from quatfilt.evaluation._written import write  # noqa: PLC0415
    from quatfilt.evaluation.reconstruction_tables_conditions import CONTROL_POINTS, MODELS  # noqa: PLC0415

    names = tuple(MODELS)
    if models is not None:
        names = tuple(
            _validation.choice(name.strip(), "--models", tuple(MODELS)) for name in models.split(",")
        )
    with progress("reconstructing") as done:
        found = tables.run(data, models=names, progress=done)
    chosen = "" if models is None else f" --models {models}"
    run = page.Run(version("quatfilt"), f"quatfilt evaluate reconstruction-tables --data DIR{chosen}")
    numbers = tables.as_dict(found, vars(run))
    written, trouble = write(
        output,
        page.STEM,
        page=page.markdown(found, run),
        numbers=numbers,
        draw=lambda path: picture.draw(found, path),
    )
    if json:
        _output.print_json(numbers)
        return
    _output.say("Mean errors by number of control points, degrees / centimetres")
    _output.print_table(
        ("model", *map(str, CONTROL_POINTS)),
        [
            (
                MODELS[model],
                *(
                    " / ".join(
                        _output.number(
                            found.mean(measure, model=model, points=count, share=1, known=False), 1
                        )
                        for measure in ("angle", "position")
                    )
                    for count in CONTROL_POINTS
                ),
            )
            for model in page.models(found)
        ],
    )
    say_written(written, trouble)


__all__ = ["reconstruction_tables"]
