#!/usr/bin/env python3
"""Draws the frame rates over the number of particles of a `bench_particles --counts-only --large --json FILE`.

    tests/benchmarks/plot_frames.py FILE.json > frames_vs_log_n.svg
"""
import json
import math
import sys

WIDTH, HEIGHT = 740, 420
LEFT, RIGHT, TOP, BOTTOM = 64, 206, 20, 48
COLORS = {"uniform": ("#1f6f8b", "#7fb8cc"), "clustered": ("#b3541e", "#e0a27d")}


def x_of(particles, low, high):
    return LEFT + (math.log10(particles) - low) / (high - low) * (WIDTH - LEFT - RIGHT)


def y_of(rate, low, high):
    return HEIGHT - BOTTOM - (math.log10(rate) - low) / (high - low) * (HEIGHT - TOP - BOTTOM)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        rows = json.load(file)["context"]["frames_vs_log_n"]
    counts = sorted({row["particles"] for row in rows})
    low, high = math.log10(counts[0]), math.log10(counts[-1])
    rates = [row[kind] for row in rows for kind in ("tree_frames_per_s", "treelet_frames_per_s")]
    least, most = math.floor(math.log10(min(rates))), math.ceil(math.log10(max(rates)))
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif" '
        'font-size="13">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
    ]
    for power in range(math.ceil(low), math.floor(high) + 1):
        x = x_of(10**power, low, high)
        out.append(f'<line x1="{x:.1f}" y1="{TOP}" x2="{x:.1f}" y2="{HEIGHT - BOTTOM}" stroke="#ddd"/>')
        out.append(
            f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">10<tspan dy="-5" font-size="9">'
            f"{power}</tspan></text>"
        )
    for decade in range(least, most + 1):
        for step in (1, 2, 5):
            rate = step * 10.0**decade
            if not 10.0**least <= rate <= 10.0**most:
                continue
            y = y_of(rate, least, most)
            out.append(f'<line x1="{LEFT}" y1="{y:.1f}" x2="{WIDTH - RIGHT}" y2="{y:.1f}" stroke="#eee"/>')
            out.append(f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{rate:g}</text>')
    middle = (LEFT + WIDTH - RIGHT) / 2
    out.append(f'<text x="{middle}" y="{HEIGHT - 8}" text-anchor="middle">particles</text>')
    out.append(
        f'<text x="16" y="{(TOP + HEIGHT - BOTTOM) / 2}" text-anchor="middle" '
        f'transform="rotate(-90 16 {(TOP + HEIGHT - BOTTOM) / 2})">frames per second</text>'
    )
    legend = TOP + 12
    for scene, (dark, light) in COLORS.items():
        for view, dash in (("far", ""), ("close", "5 4")):
            for kind, name, color in (
                ("treelet_frames_per_s", "treelets", dark),
                ("tree_frames_per_s", "tree alone", light),
            ):
                points = [
                    f'{x_of(row["particles"], low, high):.1f},{y_of(row[kind], least, most):.1f}'
                    for row in rows
                    if row["scene"] == scene and row["view"] == view
                ]
                style = f'fill="none" stroke="{color}" stroke-width="2" stroke-dasharray="{dash}"'
                out.append(f'<polyline points="{" ".join(points)}" {style}/>')
                x = WIDTH - RIGHT + 12
                out.append(f'<line x1="{x}" y1="{legend - 4}" x2="{x + 24}" y2="{legend - 4}" {style}/>')
                out.append(f'<text x="{x + 30}" y="{legend}" font-size="11">{scene}, {view}, {name}</text>')
                legend += 18
    out.append("</svg>")
    print("\n".join(out))


if __name__ == "__main__":
    main()
