"""Ctrl-C, other threads of Python, and what is left behind. Nothing here would ever end by itself."""

import _thread
import signal
import subprocess
import sys
import threading

import pytest
from conftest import ENDLESS

import stickslip

# More than enough on the slowest machine.
LONG_S = 60

CALLS = {
    "run": "study.run(threads=2)",
    "run into a directory": "study.run(sys.argv[1], threads=2)",
    "evaluate": "study.evaluate([{'speed_rad_s': -200}])",
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


def test_an_interrupted_study_goes_on(small, small_results, tmp_path):
    """A study that is interrupted again and again ends in the tables of one that never was."""
    from test_run import files

    interruptions = 0
    while True:
        timer = threading.Timer(0.05, _thread.interrupt_main)
        timer.start()
        try:
            if interruptions < 3:
                small.run(tmp_path, threads=1)
            else:
                timer.cancel()
                small.run(tmp_path, threads=1)
            timer.cancel()
            timer.join()
            break
        except KeyboardInterrupt:
            interruptions += 1
        except OSError as error:
            # Where runs that had begun are still being finished.
            assert "is writing into this directory" in str(error)
        finally:
            timer.cancel()
    assert files(tmp_path) == files(small_results)
