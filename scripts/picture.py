#!/usr/bin/env python3
"""An SVG of the first figure of a closing: what was measured less what was flown again, before and after.

    windfall close CAMPAIGN.toml --out closed && scripts/picture.py closed/figures.json "title" docs/pictures/NAME.svg
"""
import json
import sys

WIDTH, HEIGHT, LEFT, TOP, RIGHT, BOTTOM = 640, 300, 70, 34, 20, 46
LOOK = {"measured": "#444", "before": "#c0392b", "after": "#1f6fb2", "noise": "#999"}


def ticks(low, high):
    """Round values between two, four to eight of them."""
    span = high - low
    step = 10.0 ** len(str(int(span))) if span >= 1 else 1.0
    while span / step < 4:
        step /= 2 if str(step).lstrip("0.").startswith(("1", "4")) else 2.5 if str(step).lstrip("0.").startswith("5") else 2
    first = int(low / step) * step
    return [first + i * step for i in range(12) if low <= first + i * step <= high + 1e-9 * step]


def picture(figure, title):
    xs = [x for s in figure["series"] for x in s["x"]]
    ys = [y for s in figure["series"] for y in s["y"]] + [0.0]
    x0, x1, y0, y1 = min(xs), max(xs), min(ys), max(ys)
    across = lambda x: LEFT + (x - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT)
    up = lambda y: HEIGHT - BOTTOM - (y - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">']
    out.append(f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/><text x="{LEFT}" y="18" font-size="13">{title}</text>')
    for y in ticks(y0, y1):
        out.append(f'<path d="M{LEFT},{up(y):.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>')
        out.append(f'<text x="{LEFT - 6}" y="{up(y) + 4:.1f}" text-anchor="end">{y:g}</text>')
    for x in ticks(x0, x1):
        out.append(f'<text x="{across(x):.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{x:g}</text>')
    for i, s in enumerate(figure["series"]):
        path = "L".join(f"{across(x):.1f},{up(y):.1f}" for x, y in zip(s["x"], s["y"]))
        colour = LOOK.get(s["role"], "#000")
        out.append(f'<path d="M{path}" fill="none" stroke="{colour}" stroke-width="1.8"/>')
        out.append(f'<text x="{WIDTH - RIGHT - 60}" y="{TOP + 14 * (i + 1)}" fill="{colour}">{s["role"]}</text>')
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 8}" text-anchor="middle">{figure["x_label"]}</text>')
    middle = (TOP + HEIGHT - BOTTOM) / 2
    out.append(f'<text transform="rotate(-90)" x="{-middle}" y="16" text-anchor="middle">{figure["y_label"]}</text></svg>')
    return "\n".join(out) + "\n"


def main():
    source, title, target = sys.argv[1:4]
    with open(source, encoding="utf-8") as file:
        figures = json.load(file)
    with open(target, "w", encoding="utf-8") as file:
        file.write(picture(figures[0], title))


if __name__ == "__main__":
    main()
