"""Programs that the tests start, of which none outlives them."""

import shutil
import subprocess


def start(command, signal="KILL", **options):
    """Starts a program, to which the system sends this signal when the tests end, however they end (setpriv: Linux)."""
    setpriv = shutil.which("setpriv")
    bound = [setpriv, "--pdeathsig", signal, "--"] if setpriv else []
    return subprocess.Popen([*bound, *command], **options)
