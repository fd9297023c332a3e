"""The command `stickslip` of the package: the program, with its exit codes, streams and signals."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ENDLESS, ROOT, SMALL

COMMAND = [str(Path(sys.executable).parent / "stickslip")]


def call(*arguments, **options):
    return subprocess.run([*COMMAND, *map(str, arguments)], capture_output=True, text=True, **options)


@pytest.mark.parametrize(
    "arguments, code",
    [
        (["--version"], 0),
        (["--help"], 0),
        (["run", "--help"], 0),
        ([], 2),
        (["fly"], 2),
        (["check", "none.yaml"], 2),
        (["check", ROOT / "studies/smoke.yaml"], 0),
        (["completions", "bash"], 0),
        (["schema"], 0),
    ],
)
def test_it_is_the_program(program, arguments, code):
    mine, theirs = call(*arguments), program(*arguments, code=code)
    assert (mine.returncode, mine.stdout, mine.stderr) == (code, theirs.stdout, theirs.stderr)


def test_exit_codes_of_results(tmp_path):
    (tmp_path / "small.yaml").write_text(SMALL)
    done = call("run", tmp_path / "small.yaml", "--out", tmp_path / "out")
    assert done.returncode == 3, done.stderr
    assert "point" in done.stdout and "tables in" in done.stderr
    assert call("report", tmp_path / "out").returncode == 0


def test_ctrl_c_saves_finished_runs(tmp_path):
    (tmp_path / "endless.yaml").write_text(ENDLESS)
    out = tmp_path / "out"
    command = [*COMMAND, "run", str(tmp_path / "endless.yaml"), "--out", str(out)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        while not list(out.glob("chunks/*/*")):
            assert process.poll() is None
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130
    assert "interrupted after" in said and "Traceback" not in said


def catches_ctrl_c(process):
    """Whether a process has a handler for SIGINT, from its signal mask."""
    status = Path(f"/proc/{process.pid}/status").read_text()
    mask = int(status.split("SigCgt:")[1].split()[0], 16)
    return bool(mask & 1 << (signal.SIGINT - 1))


def test_ctrl_c_ends_a_command_that_only_reads(tmp_path):
    """Python's own handler would wait for the end of the command."""
    out = str(tmp_path / "answers.parquet")
    command = [*COMMAND, "evaluate", str(ROOT / "studies/design.yaml"), "--designs", "-", "--out", out]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        for expected in (True, False):
            while catches_ctrl_c(process) != expected:
                assert process.poll() is None
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == -signal.SIGINT and b"Traceback" not in said


def test_a_reader_that_stops_reading():
    line = f"'{COMMAND[0]}' schema | head -c 10"
    done = subprocess.run(["bash", "-o", "pipefail", "-c", line], capture_output=True, text=True)
    assert (done.returncode, len(done.stdout), done.stderr) == (0, 10, "")
