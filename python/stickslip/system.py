"""Mechanical systems by formulas, for studies: from dicts, from files, and from energies in SymPy."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import Any, Optional, Union

__all__ = ["System"]

#: The longest mapping on one line of YAML, in characters.
_LINE = 120
#: Keys without quotation marks: those that no version of YAML reads as a boolean or as nothing.
_KEY = re.compile(r"(?!(?:y|n|yes|no|on|off|true|false|null)$)[a-z_][a-z0-9_]*", re.IGNORECASE)
#: Characters that YAML does not allow or that end a line in it.
_CONTROL = re.compile("[\x7f-\x9f\u2028\u2029\ufeff]")
_CONSTANTS = {"true": True, "false": False, "null": None, "~": None, "": None}
_WHOLE = re.compile("[-+]?[0-9]+")
_NUMBER = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")


class System(Mapping[str, Any]):
    """A mechanical system with formulas for its mass matrix, its forces and its contacts.

    A system is a mapping with the keys of a system file, and the value of ``system`` in the ``model`` of a study. Create
    one with ``System.from_dict(keys)``, ``System.from_yaml(path)`` or ``System.from_sympy(name, ...)``. The study that
    contains it checks it.
    """

    __module__ = "stickslip"

    def __init__(self, keys: Mapping[str, Any]) -> None:
        if not isinstance(keys, Mapping):
            raise _wrong("keys", type(keys).__name__, "a dict with the keys of a system file")
        self._keys: dict[str, Any] = _plain("", keys)
        self._folder = "."

    @classmethod
    def from_dict(cls, keys: Mapping[str, Any]) -> System:
        """Creates a system from a dict with the keys of a system file.

        Raises TypeError for a value that a system file cannot contain.
        """
        return cls(keys)

    @classmethod
    def from_yaml(cls, path: Union[str, PathLike[str]]) -> System:
        """Reads a system file; needs PyYAML.

        Raises ValueError if the file is not YAML or gives a key twice, and OSError if it cannot be read.
        """
        yaml = _needed("yaml", "System.from_yaml", "pyyaml")
        try:
            # PyYAML itself reads the values of YAML 1.1, in which the key y is a boolean.
            node = yaml.compose(Path(path).read_text(encoding="utf-8"), yaml.BaseLoader)
        except yaml.YAMLError as error:
            raise ValueError(f"{path}: {error}") from error
        system = cls(_value(str(path), node))
        system._folder = str(Path(path).parent)
        return system

    @classmethod
    def from_sympy(
        cls,
        name: str,
        *,
        kinetic: Any,
        potential: Any = 0,
        forces: Optional[Mapping[Any, Any]] = None,
        coordinates: Mapping[Any, Mapping[str, Any]],
        contacts: Mapping[str, Mapping[str, Any]],
        parameters: Mapping[Any, Any],
        meaning: str = "",
        period: Any = None,
    ) -> System:
        """Derives the equations of motion from the kinetic and the potential energy; needs SymPy.

        name: the name of the system.
        kinetic, potential: the energies, expressions of SymPy.
        forces: generalised forces other than those of the potential and of contacts, by coordinate.
        coordinates: the keys of each coordinate, by a function of time such as dynamicsymbols("q") or by its name.
        contacts: the keys of each contact, by name.
        parameters: the value, or the keys, of each parameter, by symbol or name.
        meaning: what the system is, in a sentence.
        period: the time after which the equations repeat, if they contain the time.

        Forces and other formulas are expressions of SymPy, or text as in a system file. Raises ValueError for an
        expression that a system file cannot contain.
        """
        _needed("sympy", "System.from_sympy", "sympy")
        lagrange: Any = import_module("._lagrange", __package__)
        given = forces or {}
        formulas = lagrange.Formulas(coordinates, parameters, [kinetic, potential, *given.values()])
        mass, force = lagrange.equations(formulas, kinetic, potential, given)
        keys = {
            "system": name,
            **({"meaning": meaning} if meaning else {}),
            "parameters": {str(key): value for key, value in parameters.items()},
            "coordinates": {formulas.name(key): value for key, value in coordinates.items()},
            "mass": mass,
            "force": force,
            "contacts": contacts,
            **({} if period is None else {"period": period}),
        }
        return cls(_plain("", keys, formulas.formula))

    def to_dict(self) -> dict[str, Any]:
        """Returns the keys of the system file, as a copy."""
        return {key: _plain(key, value) for key, value in self._keys.items()}

    def to_yaml(self) -> str:
        """Returns the text of the system file."""
        return "\n".join(_lines(self._keys)) + "\n"

    def write(self, path: Union[str, PathLike[str]]) -> None:
        """Writes the system file."""
        Path(path).write_text(self.to_yaml(), encoding="utf-8")

    def __getitem__(self, key: str) -> Any:
        return self._keys[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._keys)

    def __len__(self) -> int:
        return len(self._keys)

    def __repr__(self) -> str:
        counts = [f"{len(self._keys.get(key) or ())} {key}" for key in ("coordinates", "contacts", "parameters")]
        return f"<stickslip.System {self._keys.get('system')}: {', '.join(counts)}>"

    def _repr_latex_(self) -> Optional[str]:
        """Returns the equations of motion for notebooks; nothing if a study in the folder of its file would refuse it."""
        shown: Optional[str] = import_module("._stickslip", __package__)._latex(self.to_yaml(), self._folder)
        return shown


def _needed(module: str, call: str, package: str) -> Any:
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(f"{call} needs {module}: pip install {package}", name=module) from error


def _wrong(place: str, found: str, allowed: str) -> TypeError:
    return TypeError(f"{place}: wrong type\n  found:   {found}\n  allowed: {allowed}")


def _plain(place: str, value: Any, formula: Optional[Callable[[str, Any], str]] = None) -> Any:
    """Returns a copy of dicts, lists, text and numbers; writes expressions of SymPy as formulas."""
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise TypeError(f"{place}: wrong type of a name\n  found:   {key}\n  allowed: names that are text")
        return {key: _plain(f"{place}.{key}".lstrip("."), one, formula) for key, one in value.items()}
    if hasattr(value, "free_symbols"):
        if formula is None:
            raise _wrong(place, "an expression of SymPy", "formulas as text, or System.from_sympy")
        if not value.is_number:
            return formula(place, value)
        return int(value) if value.is_Integer else float(value)
    if hasattr(value, "dtype") and hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(f"{place}[{number}]", one, formula) for number, one in enumerate(value)]
    if value is not None and not isinstance(value, (str, int, float)):
        raise _wrong(place, type(value).__name__, "text, numbers, and lists and dicts of them")
    return value


def _value(path: str, node: Any) -> Any:
    """Returns the value of a node of PyYAML, by the rules of YAML 1.2."""
    if node is None:
        return None
    if node.id == "sequence":
        return [_value(path, one) for one in node.value]
    if node.id == "mapping":
        keys: dict[str, Any] = {}
        for key, one in node.value:
            if key.id != "scalar" or key.value in keys:
                raise ValueError(f"{path}, line {key.start_mark.line + 1}: a key that is given twice, or that is no text")
            keys[key.value] = _value(path, one)
        return keys
    text: str = node.value
    if node.style is not None:
        return text
    if text in _CONSTANTS:
        return _CONSTANTS[text]
    return int(text) if _WHOLE.fullmatch(text) else float(text) if _NUMBER.fullmatch(text) else text


def _scalar(value: Any) -> str:
    """Returns a value as JSON, which is YAML in one line."""
    text = json.dumps(value, ensure_ascii=False, allow_nan=False)
    return _CONTROL.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def _lines(keys: Mapping[str, Any], indent: str = "") -> Iterator[str]:
    for key, value in keys.items():
        line = f"{indent}{key if _KEY.fullmatch(key) else _scalar(key)}:"
        text = _scalar(value)
        if isinstance(value, dict) and value and (not indent or len(line) + len(text) >= _LINE):
            yield line
            yield from _lines(value, indent + "  ")
        else:
            yield f"{line} {text}"
