"""The frame of a figure that a script draws: its finding as a title that is seen, and colours that follow a dark screen."""
import textwrap
from html import escape

SIZE = 17
LINE = 23
# Greys of axes and grids by what they are on a dark screen; colours of data are read on both.
DARK = {"black": "#FFFFFF", "#000000": "#FFFFFF", "#777": "#9AA0A6", "#999": "#9AA0A6", "#ddd": "#343A40", "#e5e5e5": "#343A40", "white": "#14171A"}


def framed(width, height, title, body):
    """An SVG of a body that is `width` px wide and `height` px tall, below its title."""
    lines = textwrap.wrap(title, max(int((width - 16) / (0.57 * SIZE)), 20))
    above = LINE * len(lines) + 14
    rules = "".join(f'[{kind}="{light}"]{{{kind}:{dark}}}' for light, dark in DARK.items() for kind in ("fill", "stroke"))
    heading = [f'<text x="8" y="{LINE * (k + 1)}" font-size="{SIZE}" font-weight="bold">{escape(line)}</text>' for k, line in enumerate(lines)]
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height + above}" font-family="sans-serif" font-size="12" role="img">',
        f"<title>{escape(title)}</title>",
        f"<style>@media screen and (prefers-color-scheme:dark){{text:not([fill]){{fill:#E8E8E8}}{rules}}}</style>",
        f'<rect width="{width}" height="{height + above}" fill="white"/>', *heading, f'<g transform="translate(0 {above})">', *body, "</g>", "</svg>"]) + "\n"
