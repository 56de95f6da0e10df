"""The ``polycnc`` command: thin commands over the library."""

__all__ = ["main"]


def main() -> None:
    """Run the command line."""
    import signal

    before = signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C shows nobody what is being imported
    from polycnc.cli._app import main as run

    signal.signal(signal.SIGINT, before)
    run()
