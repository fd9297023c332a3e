"""Systems by formulas: files, and equations of motion from energies in SymPy."""

import copy
import math
import pickle
import random
import re
import sys

import numpy
import pytest
from conftest import ROOT

import stickslip
from stickslip import System

KEYS = {
    "system": "block",
    "meaning": 'A block, "the first": with a damper # and a spring, 5 µm long.',
    "parameters": {"m": "1 kg", "y": {"value": 2.0e-5, "meaning": "{no} [true] null"}, "most": {"value": 2, "most": 4}},
    "coordinates": {"x": {"unit": "m", "start": [-1, 0.5], "periodic": False}, "no": {"start": ["-m / y", "1e3"]}},
    "mass": {"x": {"x": "m", "no": "m * y"}, "no": {"no": 1}},
    "force": {"x": "-x - 2 * x' + if(1 < 2, x, 0)", "no": "&a *b !c %d @e `f` \\ \n\u2028", "z[block]": "long " * 40},
    "contacts": {},
}


def test_text_has_the_keys_of_the_dict(tmp_path):
    pytest.importorskip("yaml")
    system = System.from_dict(KEYS)
    system.write(tmp_path / "block.yaml")
    assert (tmp_path / "block.yaml").read_text(encoding="utf-8") == system.to_yaml()
    read = System.from_yaml(tmp_path / "block.yaml")
    assert read.to_dict() == system.to_dict() == KEYS
    assert list(read) == list(KEYS) and read == system
    assert [type(one) for one in read["coordinates"]["x"]["start"]] == [int, float]


def test_formulas_are_quoted():
    text = System.from_dict(KEYS).to_yaml()
    assert '''  x: "-x - 2 * x' + if(1 < 2, x, 0)"\n''' in text
    assert '  "y": {"value": 2e-05, "meaning": "{no} [true] null"}\n' in text
    assert '  "no": "&a *b !c %d @e `f` \\\\ \\n\\u2028"\n' in text
    assert "  \"z[block]\": \"long" in text


def test_shipped_systems(tmp_path):
    pytest.importorskip("yaml")
    files = sorted((ROOT / "studies/systems").glob("*.yaml"))
    assert len(files) >= 4
    for path in files:
        system = System.from_yaml(path)
        system.write(tmp_path / path.name)
        assert System.from_yaml(tmp_path / path.name) == system
    woodpecker = System.from_yaml(ROOT / "studies/systems/woodpecker.yaml")
    assert list(woodpecker["mass"]["y"].items())[:2] == [("y", "m_bird + m_sleeve"), ("phi_sleeve", "m_bird * l_sleeve")]
    assert woodpecker["contacts"]["beak"]["restitution"] == 0.5


@pytest.mark.parametrize(
    "text, problem",
    [("a: 1\na: 2\n", "line 2: a key that is given twice"), ("system: [\n", "block.yaml"), ("[1]: 2\n", "line 1: a key")],
)
def test_files_with_faults(tmp_path, text, problem):
    pytest.importorskip("yaml")
    (tmp_path / "block.yaml").write_text(text)
    with pytest.raises(ValueError, match=problem):
        System.from_yaml(tmp_path / "block.yaml")


def test_a_system_keeps_a_copy_of_plain_values():
    keys = copy.deepcopy(KEYS)
    keys["coordinates"]["x"]["start"] = numpy.array([-1.0, 0.5])
    keys["parameters"]["m"] = numpy.int64(3)
    system = System.from_dict(keys)
    assert system["coordinates"]["x"]["start"] == [-1, 0.5] and system["parameters"]["m"] == 3
    system.to_dict()["parameters"]["m"] = 4
    keys["parameters"]["y"]["value"] = 5
    assert (system["parameters"]["m"], system["parameters"]["y"]["value"]) == (3, 2.0e-5)
    assert pickle.loads(pickle.dumps(system)) == system
    assert repr(system) == "<stickslip.System block: 2 coordinates, 0 contacts, 3 parameters>"
    assert system._repr_latex_() is None
    with pytest.raises(TypeError, match="force.x: wrong type\n  found:   object"):
        System.from_dict({"force": {"x": object()}})
    with pytest.raises(TypeError, match="force: wrong type of a name\n  found:   1"):
        System.from_dict({"force": {1: "x"}})
    with pytest.raises(TypeError, match="a dict with the keys of a system file"):
        System.from_dict("block.yaml")


@pytest.mark.parametrize("module, call", [("sympy", lambda: pendulum()), ("yaml", lambda: System.from_yaml("block.yaml"))])
def test_missing_packages_are_named(monkeypatch, module, call):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=f"needs {module}: pip install"):
        call()


def pendulum(**changes):
    """A pendulum, whose support moves if the kinetic energy says so."""
    keys = {"kinetic": 0, "coordinates": {"q": {"start": [-1, 1]}}, "contacts": {}, "parameters": {"m": 1, "g": 9.81}}
    return System.from_sympy("pendulum", **{**keys, **changes})


@pytest.fixture(scope="module")
def double():
    """A double pendulum with relative angles, given by name and by function, and a motor."""
    sympy = pytest.importorskip("sympy")
    mechanics = pytest.importorskip("sympy.physics.mechanics")
    m, n, a, b, g, torque, t = sympy.symbols("m n a b g torque t")
    phi, psi = mechanics.dynamicsymbols("phi psi")
    kinetic = potential = x = y = 0
    for mass, length, angle in [(m, a, phi), (n, b, phi + psi)]:
        x, y = x + length * sympy.sin(angle), y - length * sympy.cos(angle)
        kinetic += mass * (x.diff(t) ** 2 + y.diff(t) ** 2) / 2
        potential += mass * g * y
    hinge = {"normal": torque, "friction": {"coulomb": {"coefficient": 1}}}
    return System.from_sympy(
        "double_pendulum",
        kinetic=kinetic,
        potential=potential,
        forces={"phi": "-0.05 * phi' * torque / g", psi: -torque * psi.diff(t) / 8},
        coordinates={phi: {"start": [-1, sympy.pi / 4]}, "psi": {"start": [-1, 1], "start_rate": sympy.sqrt(g / a)}},
        contacts={"upper": {**hinge, "sliding": "phi'"}, "lower": {**hinge, "sliding": psi.diff(t)}},
        parameters={m: 1, "n": 0.7, a: 0.5, b: sympy.Rational(2, 5), g: 9.81, torque: {"value": 0.2, "meaning": "friction"}},
        meaning="Two bars.",
    )


def value(formula, **names):
    """The value of a formula; a rate of change q' is the name q_1."""
    text = re.sub(r"(\w)('+)", lambda found: f"{found[1]}_{len(found[2])}", str(formula)).replace("^", "**")
    return eval(text, {**vars(math), **names})


def test_a_double_pendulum(double):
    draws = random.Random(1)
    for _ in range(20):
        m, n, a, b, g, torque = (draws.uniform(0.1, 3) for _ in range(6))
        phi, psi, u, w = (draws.uniform(-3, 3) for _ in range(4))
        names = {"m": m, "n": n, "a": a, "b": b, "g": g, "torque": torque, "phi": phi, "psi": psi, "phi_1": u, "psi_1": w}
        both = n * a * b * math.cos(psi)
        assert value(double["mass"]["phi"]["phi"], **names) == pytest.approx((m + n) * a**2 + n * b**2 + 2 * both)
        assert value(double["mass"]["phi"]["psi"], **names) == pytest.approx(n * b**2 + both)
        assert double["mass"]["psi"] == {"psi": "b^2 * n"}
        pull, turn = n * g * b * math.sin(phi + psi), n * a * b * math.sin(psi)
        upper = turn * (2 * u * w + w**2) - (m + n) * g * a * math.sin(phi) - pull - 0.05 * u * torque / g
        assert value(double["force"]["phi"], **names) == pytest.approx(upper)
        assert value(double["force"]["psi"], **names) == pytest.approx(-turn * u**2 - pull - torque * w / 8)


def test_keys_beside_the_equations(double):
    assert list(double) == ["system", "meaning", "parameters", "coordinates", "mass", "force", "contacts"]
    assert double["coordinates"]["phi"] == {"start": [-1, math.pi / 4]}
    assert double["coordinates"]["psi"] == {"start": [-1, 1], "start_rate": "sqrt(g / a)"}
    assert double["contacts"]["lower"] == {"normal": "torque", "friction": {"coulomb": {"coefficient": 1}}, "sliding": "psi'"}
    assert list(double["parameters"].items())[2:5] == [("a", 0.5), ("b", 0.4), ("g", 9.81)]
    assert double["parameters"]["torque"] == {"value": 0.2, "meaning": "friction"}
    assert double["force"]["phi"].endswith(" + (-0.05 * phi' * torque / g)")
    shown = double._repr_latex_()
    assert shown.startswith(r"$\displaystyle \begin{aligned}") and shown.endswith(r"\end{aligned}$")
    assert r"\ddot{\phi}" in shown and r"- \frac{0.05 \, \dot{\phi} \, \mathit{torque}}{g}" in shown


def test_a_double_pendulum_runs(double):
    keys = {
        "schema": 1,
        "name": "double-pendulum",
        "seed": 1,
        "model": {"system": double},
        "initial_conditions": {"design": {"monte_carlo": {"samples": 4}}},
        "simulation": {"method": "event", "end_time_s": 60},
    }
    labels = stickslip.Study.from_dict(keys).run().runs["label"]
    assert labels == ["equilibrium"] * 4
    again = stickslip.Study.from_dict({**keys, "model": {"system": double.to_dict()}})
    assert again.run().runs["label"] == labels


def test_a_moving_support():
    """A kinetic energy with the time: the support moves by a(t) = d cos(w t)."""
    sympy = pytest.importorskip("sympy")
    m, g, d, w, t = sympy.symbols("m g d w t", positive=True)
    q = sympy.Function("q")(t)
    x, y = d * sympy.cos(w * t) + sympy.sin(q), -sympy.cos(q)
    system = pendulum(
        kinetic=m * (x.diff(t) ** 2 + y.diff(t) ** 2) / 2,
        potential=m * g * y,
        parameters={m: 1, g: 9.81, d: 0.1, w: 2},
        contacts={"hinge": {"normal": sympy.cos(q) * q.diff(t) ** 2 - q.diff(t, 2), "sliding": "q'"}},
        period=2 * sympy.pi / w,
    )
    assert system["mass"] == {"q": {"q": "m"}} and system["period"] == "2 * pi / w"
    assert system["contacts"]["hinge"]["normal"] == "q'^2 * cos(q) - q''"
    names = {"m": 1.5, "g": 9.81, "d": 0.3, "w": 2.5, "t": 0.7, "q": 0.4, "q_1": -1.2}
    expected = 1.5 * (0.3 * 2.5**2 * math.cos(2.5 * 0.7) * math.cos(0.4) - 9.81 * math.sin(0.4))
    assert value(system["force"]["q"], **names) == pytest.approx(expected)


def test_expressions_as_formulas():
    sympy = pytest.importorskip("sympy")
    t, m, g = sympy.symbols("t m g")
    q = sympy.Function("q")(t)
    v = q.diff(t)
    written = {
        -(q**2) / 2: "-q^2 / 2",
        3 - sympy.sqrt(q): "3 - sqrt(q)",
        q ** sympy.Rational(-3, 2): "1 / q^(3/2)",
        (q + 1) ** 2 * 1.5e-7: "1.5e-07 * (q + 1)^2",
        -sympy.exp(-q) / v: "-exp(-q) / q'",
        sympy.tanh(sympy.pi * v): "tanh(pi * q')",
        sympy.tan(q) ** 2 + sympy.sin(v) * sympy.atan(q) * sympy.cos(t): None,
        sympy.E * (-m) ** 3 - q**0.5 * (1 - q) ** -2.0: None,
        -2 * (m + g) * (q - v) / 3 - v**2 * m / g: None,
        sympy.sqrt(2) * sympy.Rational(1, 3) + t - 1.25: None,
        1 / (g * (1 + q * (2 + m))) - 1 / sympy.sqrt(q): None,
    }
    names = {"m": 0.7, "g": 9.81, "q": 1.3, "t": 0.2}
    for expression, text in written.items():
        contact = {"normal": expression, "sliding": v}
        formula = pendulum(kinetic=m * v**2 / 2, contacts={"hinge": contact})["contacts"]["hinge"]["normal"]
        number = expression.subs({v: -0.8}).subs({q: 1.3}).subs({symbol: names[symbol.name] for symbol in (m, g, t)})
        assert value(formula, q_1=-0.8, **names) == pytest.approx(float(number)), formula
        assert text in (formula, None)


def test_refused_expressions():
    sympy = pytest.importorskip("sympy")
    t, m, x = sympy.symbols("t m x")
    q, z = sympy.Function("q")(t), sympy.Function("z")(t)
    v = q.diff(t)
    kinetic = m * v**2 / 2
    contact = "a contact with a gap or with friction"
    for problem, remedy, changes in [
        ("potential: a function that is not smooth\n  found:   Abs(q(t))", contact, {"potential": sympy.Abs(q)}),
        ("Piecewise((q(t), q(t) > 0), (0, True))", contact, {"potential": sympy.Piecewise((q, q > 0), (0, True))}),
        ("forces.q: a function that is not smooth\n  found:   sign(", contact, {"forces": {q: -sympy.sign(v)}}),
        ("force.q: not a part of a formula\n  found:   log(q)", "the functions sin, cos,", {"forces": {q: sympy.log(q)}}),
        ("found:   z(t)", "the functions sin, cos,", {"forces": {q: z}}),
        ("found:   the symbol x", "a symbol with its value in `parameters`", {"potential": x * q}),
        ("found:   the symbol q", "the function of time", {"potential": q * sympy.Symbol("q", real=True)}),
        ("found:   q**(1/3)", "multiples of 1/2", {"forces": {q: sympy.cbrt(q)}}),
        ("found:   q**m", "multiples of 1/2", {"forces": {q: q**m}}),
        ("forces.q: an unknown derivative", "first and second derivatives", {"forces": {q: q.diff(t, 3)}}),
        ("kinetic: not quadratic in the rates of change", "squares", {"kinetic": kinetic + v**4}),
        ("potential: an energy that depends on a derivative", "other forces are `forces`", {"potential": q * v}),
        ("kinetic: an energy that depends on a derivative", "other forces", {"kinetic": kinetic + q.diff(t, 2) ** 2}),
        ("forces: unknown coordinate\n  found:   z", "allowed: q", {"forces": {z: 1}}),
        ("coordinates: not a coordinate\n  found:   x", "a function of time", {"coordinates": {x: {}}}),
        ("contacts.hinge.sliding: not a part", "the functions", {"contacts": {"hinge": {"sliding": sympy.asin(v)}}}),
    ]:
        with pytest.raises(ValueError) as raised:
            pendulum(**{"kinetic": kinetic, **changes})
        assert problem in str(raised.value) and remedy in str(raised.value)
    with pytest.raises(TypeError, match="kinetic: wrong type\n  found:   str"):
        pendulum(kinetic="m * v**2 / 2")
    with pytest.raises(TypeError, match="force.q: wrong type\n  found:   an expression of SymPy"):
        System.from_dict({"force": {"q": m * x}})
    # A potential whose derivative is a formula.
    assert pendulum(kinetic=kinetic, potential=sympy.log(q) * m)["force"] == {"q": "-m / q"}
