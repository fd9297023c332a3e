"""Small plots on logarithmic axes as plain SVG text, for the scripts beside this file."""

import math
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
    value = 10.0**logarithm
    return f"{value:.3g}" if 1e-3 < value < 1e4 else f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")


def panel(title, x_name, y_name, series):
    """One plot: `series` are (name, points), or (name, points, colour's number, dashes)."""
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
    for number, (name, of_series, *style) in enumerate(series):
        colour, dashes = (*style, number, "")[:2] if len(style) == 2 else (number, "")
        stroke = f'stroke="{COLOURS[colour % len(COLOURS)]}" fill="none" stroke-dasharray="{dashes}"'
        places = [place(x, y) for x, y in of_series if x > 0 and y > 0]
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
        lines.append(f'<path d="M{path}" {stroke} stroke-width="1.5"/>')
        lines += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.5" {stroke}/>' for x, y in places]
        if len(series) > 1:
            y = TOP + 14 + 14 * number
            lines.append(f'<path d="M{LEFT + 8} {y - 4}h18" {stroke} stroke-width="1.5"/>')
            lines.append(f'<text x="{LEFT + 30}" y="{y}">{escape(name)}</text>')
    return "\n".join(lines)


def figure(path, panels, columns):
    """Writes panels side by side, `columns` in a row."""
    rows = math.ceil(len(panels) / columns)
    width, height = columns * WIDTH, rows * HEIGHT
    placed = (
        f'<g transform="translate({number % columns * WIDTH} {number // columns * HEIGHT})">\n{inside}\n</g>'
        for number, inside in enumerate(panels)
    )
    path.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
        f'height="{height}" font-family="sans-serif" font-size="11">\n'
        f'<rect width="{width}" height="{height}" fill="white"/>\n' + "\n".join(placed) + "\n</svg>\n"
    )
