"""Ctrl-C, other Python threads, and the remaining files. No call in these tests ends without an interruption."""

import _thread
import json
import signal
import subprocess
import sys
import threading
import time

import pytest
from conftest import ENDLESS, assert_same

import stickslip

# More than enough on the slowest machine.
LONG_S = 60

CALLS = {
    "run": "study.run(threads=2)",
    "run into a directory": "study.run(sys.argv[1], threads=2)",
    "evaluate": "study.evaluate([{'speed_rad_s': -200}])",
    "optimize": "study.optimize(threads=2)",
    "identify": "study.identify([{'beta_1_rad': 1, 'beta_2_rad': 3, 'std_dev_rad': 0.1}])",
    # Of which nothing can be left out.
    "one long run": "stickslip.simulate({'position_m': 1}, times_s=[0], model='block_on_belt', "
    "friction_coefficient=0, simulation={'end_time_s': 2e6})",
}

CHILD = """
import sys
import stickslip
study = stickslip.Study.from_text({study!r})
try:
    print("begun", flush=True)
    {call}
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(7)
"""


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_ctrl_c(call, tmp_path):
    child = CHILD.format(study=ENDLESS, call=call)
    out = tmp_path / "out"
    process = subprocess.Popen([sys.executable, "-c", child, str(out)], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "begun\n"
        # Until runs are on their way.
        while "sys.argv" in call and not list(out.glob("chunks/*/*")):
            assert process.poll() is None
        process.send_signal(signal.SIGINT)
        rest, _ = process.communicate(timeout=LONG_S)
    finally:
        process.kill()
    assert (rest, process.returncode) == ("interrupted\n", 7)


@pytest.mark.parametrize("call", ["run", "evaluate"])
def test_other_threads_of_python_go_on(call):
    """A thread does its work while the main thread waits for a study, and then ends that."""
    study = stickslip.Study.from_text(ENDLESS)
    done = []

    def work():
        for step in range(1000):
            done.append(step)
        _thread.interrupt_main()

    worker = threading.Timer(0.2, work)
    worker.start()
    with pytest.raises(KeyboardInterrupt):
        study.run() if call == "run" else study.evaluate({"speed_rad_s": [-200]})
    worker.join()
    assert len(done) == 1000


def run_when_free(study, folder):
    """Runs a study into a directory in which runs that had begun may still be finished."""
    while True:
        try:
            return study.run(folder)
        except OSError as error:
            assert "is writing into this directory" in str(error)


def test_what_is_finished_is_kept(tmp_path):
    """A study that is interrupted, made smaller and run again has the tables of one that never was."""

    def interrupt():
        while not list(tmp_path.glob("chunks/*/*")):
            time.sleep(0.05)
        _thread.interrupt_main()

    worker = threading.Thread(target=interrupt)
    worker.start()
    with pytest.raises(KeyboardInterrupt):
        stickslip.Study.from_text(ENDLESS).run(tmp_path)
    worker.join()
    small = stickslip.Study.from_text(ENDLESS.replace("1000000000", "40"))
    results = run_when_free(small, tmp_path)
    assert json.loads((tmp_path / "manifest.json").read_text())["runs_kept"] > 0
    undisturbed = small.run()
    assert len(results.runs) == 40
    for table in ("runs", "points", "time_to_rest", "cycles", "equilibria", "equilibrium_histogram"):
        assert_same(getattr(undisturbed, table), tmp_path / f"{table}.parquet")
