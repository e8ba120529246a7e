"""Processes under load: started with pipes, spoken to in lines, ended by who started them."""

import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import IO, Any

import psutil

END_S = 5.0


class Child:
    """One process from its making to the end of the `with`. What it says on stderr is told when it fails."""

    def __init__(
        self, module: str, *words: str | Path, env: Mapping[str, str] | None = None
    ) -> None:
        self._said: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115  closed in __exit__
        command: Sequence[str] = [sys.executable, "-m", module, *map(str, words)]
        self._words = " ".join(command[2:])
        self.process = subprocess.Popen(
            command,
            env={**os.environ, **(env or {})},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._said,
            text=True,
        )

    def __enter__(self) -> "Child":
        return self

    def __exit__(self, *_: object) -> None:
        self.process.send_signal(signal.SIGCONT)
        self.process.terminate()
        try:
            self.process.communicate(timeout=END_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.communicate()
        self._said.close()

    def say(self, line: str) -> None:
        """One line to its stdin."""
        assert self.process.stdin is not None
        self.process.stdin.write(f"{line}\n")
        self.process.stdin.flush()

    def line(self) -> str:
        """The next line of its stdout. Raises RuntimeError with what it said when it has ended."""
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        if not line:
            self._said.seek(0)
            said = self._said.read().decode(errors="replace").strip().splitlines()
            raise RuntimeError(f"{self._words} ended: {said[-1] if said else ''}")
        return line.strip()

    def answer(self, question: str) -> Any:
        """What it answers to a line, as JSON."""
        self.say(question)
        return json.loads(self.line())

    def cpu_s(self) -> float:
        """Processor time until now [s]."""
        times = psutil.Process(self.process.pid).cpu_times()
        return float(times.user + times.system)

    def signal(self, number: signal.Signals) -> None:
        """Stop or kill it."""
        self.process.send_signal(number)
