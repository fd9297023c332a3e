"""Tables as people see them: aligned text in a terminal, HTML in a notebook, both of bounded size."""

from __future__ import annotations

from html import escape
from typing import Any

__all__ = ["html", "text"]

#: The number of rows that are shown at either end of a longer table.
_ENDS = 5
#: The largest number of characters of a line of text.
_WIDTH = 110
#: The largest number of characters of a cell.
_CELL = 28
#: The largest number of columns of an HTML table.
_COLUMNS = 24


def _cell(value: Any) -> str:
    """Returns a value with at most six significant digits, a missing one as a dash."""
    if value is None:
        return "-"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        shown = "[" + ", ".join(map(_cell, value[:_ENDS])) + (", …]" if len(value) > _ENDS else "]")
    else:
        # Control characters would change the terminal.
        shown = "".join(letter if letter.isprintable() else "�" for letter in str(value))
    return shown if len(shown) <= _CELL else shown[: _CELL - 1] + "…"


def _is_number(value: Any) -> bool:
    return value is None or (isinstance(value, (int, float)) and not isinstance(value, bool))


def _shown(table: Any) -> tuple[dict[str, list[Any]], bool]:
    """Returns the values of the first and the last rows, and whether rows between them are missing."""
    rows = len(table)
    if rows <= 2 * _ENDS:
        return table._rows(0, rows), False
    first, last = table._rows(0, _ENDS), table._rows(rows - _ENDS, _ENDS)
    return {name: first[name] + last[name] for name in first}, True


def _units(table: Any) -> dict[str, str]:
    """Returns the units of the columns; that of a number without a dimension is 1, without an explanation."""
    return {name: (unit or "").split(" (")[0] for name, unit in table.units.items()}


def _counted(number: int, what: str) -> str:
    return f"{number:,} {what}" + ("" if number == 1 else "s")


def _title(table: Any) -> str:
    return f"{_counted(table.num_rows, 'row')} and {_counted(table.num_columns, 'column')}"


def text(table: Any) -> str:
    """Returns the shape, the columns that fit on a line with their units, and the first and last rows."""
    values, is_cut = _shown(table)
    units = _units(table)
    lines = [""] * (2 + len(next(iter(values.values()), [])))
    shown = 0
    for name, column in values.items():
        cells = [name, units[name], *map(_cell, column)]
        width = max(map(len, cells))
        if shown and len(lines[0]) + 2 + width > _WIDTH:
            break
        is_right = all(map(_is_number, column))
        aligned = [cell.rjust(width) if is_right else cell.ljust(width) for cell in cells]
        lines = [f"{line}  {cell}" for line, cell in zip(lines, aligned)]
        shown += 1
    if is_cut:
        lines.insert(2 + _ENDS, "  …")
    left = list(values)[shown:]
    if left:
        named = ", ".join(left[:6]) + (", …" if len(left) > 6 else "")
        lines.append(f"  {_counted(len(left), 'further column')}: {named}")
    return "\n".join([f"<stickslip.Table of {_title(table)}>", *(line.rstrip() for line in lines)])


def html(table: Any) -> str:
    """Returns an HTML table with the shape below it; the title of a column is its meaning."""
    values, is_cut = _shown(table)
    units, meanings = _units(table), table.meanings
    names = list(values)[:_COLUMNS]
    cut = len(values) - len(names)

    def row(cells: list[str], more: str) -> str:
        return "<tr>" + "".join(cells) + (f"<{more}>…</{more}>" if cut else "") + "</tr>"

    def cell(value: Any) -> str:
        align = "right" if _is_number(value) else "left"
        return f'<td style="text-align: {align}">{escape(_cell(value))}</td>'

    head = [f'<th title="{escape(meanings[name] or "")}">{escape(name)}</th>' for name in names]
    below = [f"<th>{escape(units[name])}</th>" for name in names]
    count = len(values[names[0]]) if names else 0
    rows = [row([cell(values[name][place]) for name in names], "td") for place in range(count)]
    if is_cut:
        rows.insert(_ENDS, row(["<td>⋮</td>" for _ in names], "td"))
    return (
        f"<div><table><thead>{row(head, 'th')}{row(below, 'th')}</thead>"
        f"<tbody>{''.join(rows)}</tbody></table><p>{_title(table)}</p></div>"
    )
