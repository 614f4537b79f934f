import typer

evaluate = typer.Typer(name="evaluate", help="Measure the methods as the papers do.")
