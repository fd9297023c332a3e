"""Equations of motion from energies, and expressions of SymPy as formulas of system files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib import import_module
from typing import Any

__all__ = ["Formulas", "equations"]

# SymPy has no types.
sympy: Any = import_module("sympy")

#: The functions of formulas, without the square root.
_FUNCTIONS = (sympy.sin, sympy.cos, sympy.tan, sympy.exp, sympy.tanh, sympy.atan)
#: Functions with a kink or a jump.
_KINKED = (sympy.Abs, sympy.sign, sympy.Max, sympy.Min, sympy.Piecewise, sympy.Heaviside, sympy.floor, sympy.ceiling, sympy.Mod)
_KNOWN = "numbers, pi, + - * / ^ and the functions sin, cos, tan, exp, sqrt, tanh and atan"


def _refused(what: str, problem: str, found: object, allowed: str) -> ValueError:
    return ValueError(f"{what}: {problem}\n  found:   {found}\n  allowed: {allowed}")


def _is_function(key: Any) -> bool:
    return isinstance(key, sympy.core.function.AppliedUndef) and len(key.args) == 1 and key.args[0].is_Symbol


def _expanded(expression: Any) -> Any:
    # An expanded power of e could overflow.
    return sympy.expand(expression, power_exp=False)


class Formulas:
    """The names of a system, and expressions of SymPy as its formulas."""

    def __init__(self, coordinates: Iterable[Any], parameters: Iterable[Any], expressions: Iterable[Any]) -> None:
        """The expressions contain the functions of coordinates that are given by name."""
        parts = [part for one in expressions if isinstance(one, sympy.Basic) for part in one.atoms(sympy.Function)]
        known = {self.name(part): part for part in parts if _is_function(part)}
        functions = {self.name(key): key for key in coordinates}
        time = sympy.Symbol("t")
        for name, key in functions.items():
            functions[name] = key if _is_function(key) else known.get(name, sympy.Function(name)(time))
        self.functions = functions
        self.parameters = {str(name) for name in parameters}
        self.time = time
        # Partial derivatives need symbols in place of functions.
        self.positions, self.rates, self.accelerations = (
            [sympy.Symbol(name + primes) for name in functions] for primes in ("", "'", "''")
        )
        self._derivatives: dict[Any, Any] = {}
        self._plain: dict[Any, Any] = {}
        places = zip(functions.values(), self.positions, self.rates, self.accelerations)
        for function, position, rate, acceleration in places:
            clock = function.args[0]
            self._derivatives.update({function.diff(clock): rate, function.diff(clock, 2): acceleration})
            self._plain.update({function: position, clock: time})
        self._symbols = {time, *self.positions, *self.rates, *self.accelerations}

    @staticmethod
    def name(key: Any) -> str:
        """Returns the name of a coordinate."""
        if isinstance(key, str):
            return key
        if not _is_function(key):
            raise _refused("coordinates", "not a coordinate", key, 'a name, or a function of time such as dynamicsymbols("q")')
        return str(key.func.__name__)

    def symbolic(self, what: str, given: Any) -> Any:
        """Returns an expression with symbols in place of coordinates and their derivatives."""
        try:
            expression = sympy.sympify(given, strict=True).doit()
        except sympy.SympifyError:
            expression = None
        if not isinstance(expression, sympy.Expr):
            raise TypeError(f"{what}: wrong type\n  found:   {type(given).__name__}\n  allowed: an expression of SymPy")
        for kinked in expression.atoms(*_KINKED):
            remedy = "a smooth expression; what has a kink or a jump is a contact with a gap or with friction"
            raise _refused(what, "a function that is not smooth", kinked, remedy)
        expression = expression.xreplace(self._derivatives)
        for derivative in expression.atoms(sympy.Derivative):
            raise _refused(what, "an unknown derivative", derivative, "first and second derivatives of coordinates")
        return expression.xreplace(self._plain)

    def formula(self, what: str, given: Any) -> str:
        """Returns an expression as a formula."""
        expression = self.symbolic(what, given)
        try:
            return self._sum(expression)
        except _Unknown as error:
            found, allowed = error.args
            raise _refused(what, "not a part of a formula", found, allowed) from None

    def _sum(self, expression: Any) -> str:
        text = ""
        for term in expression.as_ordered_terms() if expression.is_Add else [expression]:
            is_negative = term.as_coeff_Mul()[0].is_negative
            product = self._product(-term if is_negative else term)
            sign = ("-" if is_negative else "") if not text else " - " if is_negative else " + "
            text += sign + product
        return text

    def _product(self, expression: Any) -> str:
        above, below = [], []
        for factor in expression.as_ordered_factors() if expression.is_Mul else [expression]:
            base, exponent = (factor.base, factor.exp) if factor.is_Pow else (factor, sympy.S.One)
            if factor.is_Rational:
                above += [str(factor.p)] if factor.p != 1 else []
                below += [str(factor.q)] if factor.q != 1 else []
            elif exponent.is_negative and exponent.is_number:
                below.append(self._power(base, -exponent))
            else:
                above.append(self._power(base, exponent))
        return " * ".join(above or ["1"]) + "".join(f" / {one}" for one in below)

    def _power(self, base: Any, exponent: Any) -> str:
        twice = 2 * float(exponent) if exponent.is_Rational or exponent.is_Float else 0.5
        if not twice.is_integer():
            raise _Unknown(sympy.Pow(base, exponent), "exponents that are multiples of 1/2")
        if twice == 1:
            return f"sqrt({self._sum(base)})"
        power = f"{int(twice) // 2}" if twice % 2 == 0 else f"({int(twice)}/2)"
        return self._atom(base) + (f"^{power}" if twice != 2 else "")

    def _atom(self, one: Any) -> str:
        if one.is_Symbol:
            if one in self._symbols or (one.name in self.parameters and one.name not in self.functions):
                return str(one.name)
            remedy = "the function of time" if one.name in self.functions else "a symbol with its value in `parameters`"
            raise _Unknown(f"the symbol {one}", remedy)
        if one in (sympy.pi, sympy.E):
            return "pi" if one == sympy.pi else "exp(1)"
        if (one.is_Integer or one.is_Float) and not one.is_negative:
            return str(one) if one.is_Integer else repr(float(one))
        if one.is_Add or one.is_Mul or one.is_Pow or one.is_Rational or one.is_Float:
            return f"({self._sum(one)})"
        if isinstance(one, _FUNCTIONS):
            return f"{one.func.__name__}({self._sum(one.args[0])})"
        raise _Unknown(one, _KNOWN)


class _Unknown(Exception):
    """What no formula contains, and what is allowed in its place."""


def equations(
    formulas: Formulas, kinetic: Any, potential: Any, forces: Mapping[Any, Any]
) -> tuple[dict[str, dict[str, str]], dict[str, str]]:
    """Returns the mass matrix and the forces of Lagrange's equations."""
    names, positions, rates = list(formulas.functions), formulas.positions, formulas.rates
    energy = _expanded(sympy.trigsimp(_expanded(formulas.symbolic("kinetic", kinetic))))
    stored = formulas.symbolic("potential", potential)
    for what, one, wrong in [("kinetic", energy, []), ("potential", stored, rates)]:
        if one.has(*wrong, *formulas.accelerations):
            allowed = "positions, and rates of change in the kinetic energy; other forces are `forces`"
            raise _refused(what, "an energy that depends on a derivative", one, allowed)
    mass = sympy.Matrix([[_expanded(energy.diff(one, other)) for other in rates] for one in rates])
    if mass.has(*rates):
        raise _refused("kinetic", "not quadratic in the rates of change", energy, "at most squares of rates of change")
    given = {formulas.name(key): force for key, force in forces.items()}
    for name in set(given) - set(names):
        raise _refused("forces", "unknown coordinate", name, ", ".join(names))
    rows, force = {}, {}
    for place, (name, position, rate) in enumerate(zip(names, positions, rates)):
        row = {other: mass[place, column] for column, other in enumerate(names) if column >= place}
        rows[name] = {other: formulas.formula(f"mass.{name}.{other}", entry) for other, entry in row.items() if entry != 0}
        momentum = energy.diff(rate)
        changes = sum(momentum.diff(other) * speed for other, speed in zip(positions, rates))
        own = energy.diff(position) - stored.diff(position) - changes - momentum.diff(formulas.time)
        further = given.get(name, 0)
        text = further if isinstance(further, str) else None
        own = _expanded(own if text is not None else own + formulas.symbolic(f"forces.{name}", further))
        terms = [] if own == 0 else [formulas.formula(f"force.{name}", own)]
        terms += [] if text is None else [f"({text})"]
        if terms:
            force[name] = " + ".join(terms)
    return {name: row for name, row in rows.items() if row}, force
