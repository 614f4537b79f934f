"""``quatfilt evaluate bilateral-figs``: figures 2 to 4 of Courty."""

from importlib.metadata import version

from quatfilt import _validation
from quatfilt.cli import _output
from quatfilt.cli.evaluate._options import RESULTS, Data, Json, Output, Seeds, progress, say_written


def bilateral_figs(
    *,
    data: Data = None,
    seeds: Seeds = 5,
    output: Output = RESULTS,
    json: Json = False,
) -> None:
    """Measure the bilateral filter as its paper does: error by passes, angular speed, path of a hand, time.

    Writes bilateral-figs.md, bilateral-figs.json and, with matplotlib, bilateral-figs.png.
    """
    # SciPy would slow down every verb.
    from quatfilt.evaluation import bilateral_figs, bilateral_figs_page, bilateral_figs_picture  # noqa: PLC0415
    from quatfilt.evaluation._written import write  # noqa: PLC0415
    from quatfilt.evaluation.bilateral_figs_conditions import PASSES  # noqa: PLC0415

    _validation.integer(seeds, "--seeds", at_least=1)
    with progress("filtering") as done:
        figures = bilateral_figs.run(data, seeds=seeds, progress=done)
    run = bilateral_figs_page.Run(
        seeds,
        version("quatfilt"),
        f"quatfilt evaluate bilateral-figs{' --data DIR' if data else ''} --seeds {seeds}",
    )
    numbers = bilateral_figs_page.as_dict(figures, run)
    written, trouble = write(
        output,
        bilateral_figs_page.STEM,
        page=bilateral_figs_page.markdown(figures, run),
        numbers=numbers,
        draw=lambda path: bilateral_figs_picture.draw(figures, path),
    )
    if json:
        _output.print_json(numbers)
        return
    curves = figures.curves[0]
    _output.say(f"MSE of {figures.drawn.joint} by passes, 10⁻³ rad² on S³; noisy {1e3 * curves.noisy:.2f}")
    _output.print_table(
        ("σ_g", *map(str, range(1, PASSES + 1))),
        [
            (_output.number(sigma), *(_output.number(1e3 * value) for value in values))
            for sigma, values in curves.joint.items()
        ],
    )
    say_written(written, trouble)


__all__ = ["bilateral_figs"]
