"""Runs `stickslip evaluate STUDY --designs -` as a server and sends it one design after another.

    with Server("studies/design.yaml") as server:
        answer = server.ask({"speed_rad_s": -216, "balls": 2, "material": "steel"})
        print(answer["responses"]["vibration"]["value"])

The program is the file in the variable STICKSLIP, or `stickslip` on the path. Needs only Python 3.9.
"""

import argparse
import contextlib
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass


class StickslipError(Exception):
    """The program could not be started or did not answer; the text is its message."""


class Refused(StickslipError):
    """The study does not allow a design; the text names the variable and what is allowed."""


class Missing(StickslipError):
    """A response has no value; the text has the reason."""


@dataclass(frozen=True)
class Variable:
    """A variable of the study's `design`: a range, or a list of choices."""

    name: str
    unit: str = None  # "1" for a dimensionless variable, None for choices
    low: float = None
    high: float = None
    integer: bool = False  # whole numbers only
    choices: tuple = ()

    def takes(self, value):
        """Returns whether the variable may have this value."""
        if self.choices:
            return value in self.choices
        is_number = isinstance(value, (int, float)) and self.low <= value <= self.high
        return is_number and (not self.integer or value == int(value))

    def values(self):
        """Returns its values in words."""
        if self.choices:
            return ", ".join(self.choices)
        kind = "a whole number" if self.integer else "a number"
        return f"{kind} from {self.low:g} to {self.high:g}"


class Server:
    """The program with one study. Ctrl-C and errors end it; the next request starts it again."""

    def __init__(self, study, program=None):
        self.study = str(study)
        self.program = program or os.environ.get("STICKSLIP") or "stickslip"
        if shutil.which(self.program) is None:
            raise StickslipError(f"{self.program}: no such program; set STICKSLIP to its path")
        self._process = self._said = None
        about = self._about()
        self.variables = [_variable(entry) for entry in about["design"]]
        self.responses = {entry["name"]: entry["unit"] for entry in about["responses"]}
        for key, entries in (("design", self.variables), ("responses", self.responses)):
            if not entries:
                raise StickslipError(f"{self.study}: `{key}` is missing; add it to the study")

    def ask(self, design):
        """Returns the answer to a design, given as values by names, as docs/evaluate.md describes it; raises `Refused`."""
        try:
            self._start()
            # NumPy numbers convert themselves to Python numbers.
            line = json.dumps(design, default=lambda number: number.item())
            self._process.stdin.write(line + "\n")
            self._process.stdin.flush()
            answer = self._process.stdout.readline()
            if not answer.endswith("\n"):
                raise BrokenPipeError
        except BrokenPipeError:
            # The program has ended with a message.
            raise StickslipError(self._end() or "stickslip ended without a message") from None
        except BaseException:
            # A late answer must not be taken for that of the next request.
            self._end()
            raise
        answer = json.loads(answer)
        if "error" in answer:
            raise Refused(_sentence(answer["error"], design))
        return answer

    def values(self, design, names):
        """Returns the values of these responses; raises `Missing` if one has no value, and `Refused`."""
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
        variables = {variable.name: variable for variable in self.variables}
        for name, value in fixed.items():
            if name not in variables:
                allowed = ", ".join(variables)
                raise StickslipError(f"{name}: not a variable of {self.study}: {allowed}")
            if not variables[name].takes(value):
                allowed = variables[name].values()
                raise StickslipError(f"--fix {name}: found {value}, allowed {allowed}")
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
        """Returns what `stickslip check` reports on the study."""
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
                # Ctrl-C must reach only this process, whose optimiser may want to end cleanly.
                start_new_session=True,
            )

    def _end(self):
        """Ends the program and returns its messages on standard error."""
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
    """Parses a NAME=VALUE argument; values that are numbers become numbers."""
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


def least_values(texts):
    """Parses the NAME=NUMBER arguments of constraints."""
    values = assignments(texts)
    for name, value in values.items():
        if not isinstance(value, float) or not math.isfinite(value):
            raise StickslipError(f"--at-least {name}={value}: not a constraint; give NAME=NUMBER")
    return values


def count(text):
    """Parses a number of designs or samples, for `argparse`."""
    if not (text.isascii() and text.isdigit() and int(text) > 0):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 1")
    return int(text)


def parser_of(client, description):
    """Returns the parser of a client's command line, with the study as its first argument."""
    parser = argparse.ArgumentParser(
        prog=client, description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("study", help="the study file, with `design` and `responses`")
    return parser


@contextlib.contextmanager
def messages_of(client, *errors):
    """Ends a client with a message if a package is missing, the program refuses, or one of `errors` occurs."""
    try:
        yield
    except ModuleNotFoundError as missing:
        allowed = "pip install -r scripts/clients/requirements.txt"
        sys.exit(f"{client}: {missing}\n  allowed: {allowed}")
    except (StickslipError, *errors) as error:
        sys.exit(f"{client}: {error}")


def print_answer(server, design):
    """Prints a design as a request, and its answer."""
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
        integer=entry.get("integer", False),
        choices=tuple(entry.get("choices", ())),
    )


def _sentence(error, design):
    """Returns an error of an answer in one line."""
    subject = f"{error['variable']}: " if "variable" in error else ""
    found = f"found {error['found']}, allowed {error['allowed']}"
    return f"{subject}{error['problem']}: {found} (design {design})"
