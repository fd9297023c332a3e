"""Small plots on logarithmic axes as plain SVG text, for the scripts beside this file."""

import math
import re
from html import escape

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7")
WIDTH, HEIGHT = 320, 250
LEFT, RIGHT, TOP, BOTTOM = 62, 14, 30, 44


def _ticks(low, high):
    """Powers of ten within a range of logarithms, or 1, 2, 5 of each where there are few."""
    decades = range(math.floor(low), math.ceil(high) + 1)
    factors = (1,) if high - low > 2 else (1, 2, 5)
    values = (math.log10(factor) + decade for decade in decades for factor in factors)
    return [value for value in values if low - 1e-9 <= value <= high + 1e-9]


def _number(logarithm):
    """A number as short as may be: 0.05, 200, 1e4."""
    value = 10.0**logarithm
    if 1e-2 < value < 9e3:
        return f"{value:.3g}" if value < 1e3 else f"{value:.0f}"
    digits, power = f"{value:.0e}".split("e")
    return f"{digits}e{int(power)}"


def _style(number, colour=None, dashes="none"):
    colour = COLOURS[(number if colour is None else colour) % len(COLOURS)]
    return f'stroke="{colour}" stroke-width="1.5" stroke-dasharray="{dashes}"'


def panel(title, x_name, y_name, series):
    """One plot: `series` are (name, points), or (name, points, number of the colour, dashes)."""
    points = [(x, y) for _, points, *_ in series for x, y in points if x > 0 and y > 0]
    logs = [[math.log10(value) for value in axis] for axis in zip(*points)]
    (x_low, x_high), (y_low, y_high) = ((min(axis), max(axis)) for axis in logs)
    x_pad = 0.04 * (x_high - x_low) or 0.1
    y_pad = max(0.08 * (y_high - y_low), 0.15)
    x_low, x_high, y_low, y_high = x_low - x_pad, x_high + x_pad, y_low - y_pad, y_high + y_pad
    across, up = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM

    def place(x, y):
        return (
            LEFT + across * (math.log10(x) - x_low) / (x_high - x_low),
            TOP + up * (1 - (math.log10(y) - y_low) / (y_high - y_low)),
        )

    lines = [
        f'<text x="{WIDTH / 2:.0f}" y="16" text-anchor="middle" font-weight="bold">{escape(title)}</text>',
        f'<rect x="{LEFT}" y="{TOP}" width="{across}" height="{up}" fill="none" stroke="#888"/>',
        f'<text x="{LEFT + across / 2:.0f}" y="{HEIGHT - 8}" text-anchor="middle">{escape(x_name)}</text>',
        f'<text transform="translate(13 {TOP + up / 2:.0f}) rotate(-90)" text-anchor="middle">'
        f"{escape(y_name)}</text>",
    ]
    for tick in _ticks(x_low, x_high):
        x, _ = place(10**tick, 10**y_low)
        lines.append(f'<path d="M{x:.1f} {TOP}v{up}" stroke="#ddd"/>')
        lines.append(f'<text x="{x:.1f}" y="{TOP + up + 14}" text-anchor="middle">{_number(tick)}</text>')
    for tick in _ticks(y_low, y_high):
        _, y = place(10**x_low, 10**tick)
        lines.append(f'<path d="M{LEFT} {y:.1f}h{across}" stroke="#ddd"/>')
        lines.append(f'<text x="{LEFT - 5}" y="{y + 4:.1f}" text-anchor="end">{_number(tick)}</text>')
    for number, (_, of_series, *style) in enumerate(series):
        style = _style(number, *style)
        places = [place(x, y) for x, y in of_series if x > 0 and y > 0]
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
        lines.append(f'<path d="M{path}" fill="none" {style}/>')
        for x, y in places:
            circle = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.5" fill="white" {style}/>'
            lines.append(re.sub('stroke-dasharray="[^"]*"', "", circle))
    return "\n".join(lines)


def _legend(series, top):
    lines = []
    for number, (name, _, *style) in enumerate(series):
        x = LEFT + number * 140
        lines.append(f'<path d="M{x} {top}h24" {_style(number, *style)}/>')
        lines.append(f'<text x="{x + 30}" y="{top + 4}">{escape(name)}</text>')
    return "\n".join(lines)


def figure(path, panels, columns, legend=()):
    """Writes panels side by side, `columns` in a row, and what the series of one, `legend`, are called."""
    rows = -(-len(panels) // columns)
    width, height = columns * WIDTH, rows * HEIGHT + (24 if legend else 0)
    placed = [
        f'<g transform="translate({number % columns * WIDTH} {number // columns * HEIGHT})">\n{inside}\n</g>'
        for number, inside in enumerate(panels)
    ]
    path.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
        f'height="{height}" font-family="sans-serif" font-size="11">\n'
        f'<rect width="{width}" height="{height}" fill="white"/>\n'
        + "\n".join([*placed, _legend(legend, rows * HEIGHT + 8)])
        + "\n</svg>\n"
    )
