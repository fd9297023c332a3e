"""Tests of the module stickslip_server, on reduced studies."""

import signal

import numpy as np

from clients_under_test import BLOCK, ROOT, Clients, stop_s
from stickslip_server import Missing, Refused, Server, StickslipError


class TestServer(Clients):
    def test_the_study_is_known(self):
        with Server(self.balancer) as server:
            speed, balls, material = server.variables
            self.assertEqual(
                (speed.name, speed.unit, speed.low, speed.high),
                ("speed_rad_s", "rad/s", -260, -140),
            )
            self.assertEqual((balls.integer, balls.low, balls.high), (True, 1, 3))
            self.assertEqual(material.choices, ("steel", "ceramic"))
            self.assertEqual(server.responses["time_to_rest"], "s")

    def test_answers_and_refusals(self):
        with Server(self.block) as server:
            design = {
                "stiffness_n_m": np.float64(100),
                "friction_coefficient": 0.1,
                "mass_kg": np.int64(1),
            }
            answer = server.ask(design)
            process = server._process
            stop = answer["responses"]["stop"]["value"]
            self.assertAlmostEqual(stop, stop_s(100, 0.1, 1), delta=1e-8)
            self.assertEqual(server.values(design, ["amplitude", "stop"]), [0.0, stop])
            with self.assertRaisesRegex(
                Refused, "mass_kg: out of range: found 3, allowed a number from 0.5"
            ):
                server.ask({**design, "mass_kg": 3})
            with self.assertRaisesRegex(Refused, "mass_kg: missing"):
                server.ask({"stiffness_n_m": 100, "friction_coefficient": 0.1})
            with self.assertRaisesRegex(
                StickslipError, "stopp: not a response of .*: stop, amplitude"
            ):
                server.values(design, ["stopp"])
            # All of this uses one process.
            self.assertIs(server._process, process)
        self.assertEqual(process.returncode, 0)

    def test_what_no_run_supports(self):
        never = BLOCK.replace("method: event", "method: event, end_time_s: 0.1")
        with Server(self.write("never.yaml", never)) as server:
            design = {"stiffness_n_m": 40, "friction_coefficient": 0.05, "mass_kg": 2}
            with self.assertRaisesRegex(Missing, "stop has no value: no run came to rest"):
                server.values(design, ["stop"])

    def test_studies_that_make_no_sense(self):
        wrong = self.write("wrong.yaml", BLOCK.replace("mass_kg: {", "mas_kg: {"))
        with self.assertRaisesRegex(StickslipError, r"wrong.yaml:\d+:\d+: `design.mas_kg`"):
            Server(wrong)
        for key in ("responses", "design"):
            nothing = self.write("nothing.yaml", BLOCK.split(f"\n{key}:")[0])
            with self.assertRaisesRegex(StickslipError, f"nothing.yaml: `{key}` is missing; add"):
                Server(nothing)
        with self.assertRaisesRegex(StickslipError, "set STICKSLIP"):
            Server(self.block, program="no-such-program")

    def test_a_killed_program_is_started_again(self):
        design = {"stiffness_n_m": 100, "friction_coefficient": 0.1, "mass_kg": 1}
        with Server(self.block) as server:
            first = server.ask(design)
            server._process.kill()
            server._process.wait()
            with self.assertRaises(StickslipError):
                server.ask(design)
            self.assertEqual(server.ask(design), first)

    def test_an_interrupted_question_is_forgotten(self):
        # Interrupts a request of minutes; the next request must get its own answer.
        slow = (ROOT / "studies/design.yaml").read_text().replace("samples: 64", "samples: 1000000")
        with Server(self.write("slow.yaml", slow)) as server:
            design = {"speed_rad_s": -216, "balls": 2, "material": "steel"}
            old = signal.signal(signal.SIGALRM, signal.default_int_handler)
            self.addCleanup(signal.signal, signal.SIGALRM, old)
            signal.setitimer(signal.ITIMER_REAL, 0.5)
            with self.assertRaises(KeyboardInterrupt):
                server.ask(design)
            with self.assertRaisesRegex(Refused, "balls: out of range"):
                server.ask({**design, "balls": 9})
