"""A `stickslip evaluate STUDY --designs -` that is kept up and asked design by design.

    with Server("studies/design.yaml") as server:
        answer = server.ask({"speed_rad_s": -216, "balls": 2, "material": "steel"})
        print(answer["responses"]["vibration"]["value"])

The program is the one that the variable STICKSLIP names, or `stickslip` on the path. Needs Python
3.9 and nothing else.
"""

import contextlib
import json
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass


class StickslipError(Exception):
    """The program could not be started or asked; the text is its own."""


class Refused(StickslipError):
    """A design that the study does not allow; the text says which variable, and what is allowed."""


class Missing(StickslipError):
    """The runs of a design do not say what a response is; the text has the reason."""


@dataclass(frozen=True)
class Variable:
    """A variable of the study's `design`: a range, or names to choose from."""

    name: str
    unit: str = None  # "1" where it has none, None of choices
    low: float = None
    high: float = None
    whole: bool = False  # whole numbers only
    choices: tuple = ()


class Server:
    """The program with one study. Ctrl-C and errors end it; the next question starts it again."""

    def __init__(self, study, program=None):
        self.study = str(study)
        self.program = program or os.environ.get("STICKSLIP") or "stickslip"
        if shutil.which(self.program) is None:
            raise StickslipError(f"{self.program}: no such program; set STICKSLIP to its path")
        self._process = self._said = None
        about = self._about()
        self.variables = [_variable(entry) for entry in about["design"]]
        self.responses = {entry["name"]: entry["unit"] for entry in about["responses"]}

    def ask(self, design):
        """The answer to a design, values by names, as docs/evaluate.md has it; raises `Refused`."""
        try:
            self._start()
            # Numbers of NumPy know how to become Python's own.
            line = json.dumps(design, default=lambda number: number.item())
            self._process.stdin.write(line + "\n")
            self._process.stdin.flush()
            answer = self._process.stdout.readline()
            if not answer.endswith("\n"):
                raise BrokenPipeError
        except BrokenPipeError:
            # It has ended, and has said why.
            raise StickslipError(self._end() or "stickslip ended without a word") from None
        except BaseException:
            # What it says next would be the answer to this question.
            self._end()
            raise
        answer = json.loads(answer)
        if "error" in answer:
            raise Refused(_sentence(answer["error"], design))
        return answer

    def values(self, design, names):
        """The values of these responses; raises `Missing` where there is none, `Refused`."""
        answer = self.ask(design)
        if "points" in answer:
            raise StickslipError(f"{self.study}: has a `sweep`, and a design a value at each point")
        unknown = [name for name in names if name not in self.responses]
        if unknown:
            raise StickslipError(
                f"{unknown[0]}: not a response of {self.study}: {', '.join(self.responses)}"
            )
        values = []
        for name in names:
            estimate = answer["responses"][name]
            if estimate["value"] is None:
                raise Missing(f"{name} has no value: {estimate['reason']} (design {design})")
            values.append(estimate["value"])
        return values

    def split(self, texts):
        """The variables that are free, and the values of others.

        These are given as NAME=VALUE, or have ranges of one value.
        """
        fixed = assignments(texts)
        names = [variable.name for variable in self.variables]
        for name in fixed:
            if name not in names:
                raise StickslipError(f"{name}: not a variable of {self.study}: {', '.join(names)}")
        for variable in self.variables:
            if variable.low is not None and variable.low == variable.high:
                fixed.setdefault(variable.name, variable.low)
        return [one for one in self.variables if one.name not in fixed], fixed

    def close(self):
        """Ends the program."""
        if self._process is not None:
            with contextlib.suppress(BrokenPipeError, subprocess.TimeoutExpired):
                self._process.stdin.close()
                self._process.wait(timeout=5)
            self._end()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _about(self):
        """What the program knows of the study."""
        command = [self.program, "check", self.study, "--json"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise StickslipError(done.stderr.strip())
        return json.loads(done.stdout)

    def _start(self):
        if self._process is None:
            self._said = tempfile.TemporaryFile("w+")
            self._process = subprocess.Popen(
                [self.program, "evaluate", self.study, "--designs", "-"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._said,
                text=True,
                # Ctrl-C is for this program, which may have an optimiser that wants to end well.
                start_new_session=True,
            )

    def _end(self):
        """Ends the program, which keeps nothing; what it has said on standard error."""
        process, self._process = self._process, None
        if process is None:
            return ""
        process.kill()
        for pipe in (process.stdin, process.stdout):
            with contextlib.suppress(BrokenPipeError):
                pipe.close()
        process.wait()
        with self._said:
            self._said.seek(0)
            return self._said.read().strip()


def assignments(texts):
    """What a command line says as NAME=VALUE, as numbers where they are such."""
    values = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals:
            raise StickslipError(f"{text}: not NAME=VALUE")
        try:
            values[name] = float(value)
        except ValueError:
            values[name] = value
    return values


def print_answer(server, design):
    """Prints a design as a request and what is answered."""
    print("design:", json.dumps(design, default=lambda number: number.item()))
    for name, entry in server.ask(design)["responses"].items():
        value, unit = entry["value"], server.responses[name].replace("1", "")
        if value is None:
            print(f"  {name}: nothing, {entry['reason']}")
        else:
            ends = ["?" if entry[end] is None else f"{entry[end]:.4g}" for end in ("low", "high")]
            print(f"  {name}: {value!r} {unit}".rstrip() + f" ({ends[0]} to {ends[1]})")


def _variable(entry):
    return Variable(
        name=entry["name"],
        unit=entry.get("unit"),
        low=entry.get("from"),
        high=entry.get("to"),
        whole=entry.get("whole", False),
        choices=tuple(entry.get("choices", ())),
    )


def _sentence(error, design):
    """An error of an answer in one line."""
    subject = f"{error['variable']}: " if "variable" in error else ""
    found = f"found {error['found']}, allowed {error['allowed']}"
    return f"{subject}{error['problem']}: {found} (design {design})"
