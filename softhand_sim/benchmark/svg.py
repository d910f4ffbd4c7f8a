"""Drawings as SVG text: no plotting library, and a web page can hold them as they are."""

from dataclasses import dataclass, field
from html import escape

FONT = "font-family='sans-serif'"
INK, GRID = "#333", "#ddd"
# Okabe and Ito's colours, told apart with any colour vision (M. Okabe, K. Ito, "Color Universal Design", 2008)
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#999933")


@dataclass(kw_only=True)
class Drawing:
    """A drawing of a size in pixels, y downward; grows with each call."""

    width: float
    height: float
    parts: list[str] = field(default_factory=list)

    def line(self, x1: float, y1: float, x2: float, y2: float, *, colour: str = INK, width: float = 1.0) -> None:
        """Draw a straight line."""
        self.parts.append(
            f"<line x1='{x1:.1f}' y1='{y1:.1f}' x2='{x2:.1f}' y2='{y2:.1f}' "
            f"stroke='{colour}' stroke-width='{width:g}'/>"
        )

    def dot(self, x: float, y: float, *, colour: str, radius: float = 3.0) -> None:
        """Draw a filled circle."""
        self.parts.append(f"<circle cx='{x:.1f}' cy='{y:.1f}' r='{radius:g}' fill='{colour}'/>")

    def box(self, x: float, y: float, width: float, height: float, *, colour: str, edge: str = "none") -> None:
        """Draw a filled rectangle from its upper left corner."""
        self.parts.append(
            f"<rect x='{x:.1f}' y='{y:.1f}' width='{width:.1f}' height='{height:.1f}' fill='{colour}' stroke='{edge}'/>"
        )

    def text(
        self, x: float, y: float, text: str, *, size: float = 12.0, anchor: str = "middle", colour: str = INK,
        turned: bool = False,
    ) -> None:  # fmt: skip
        """Write `text` with its base line at x, y; `turned` reads upward."""
        turn = f" transform='rotate(-90 {x:.1f} {y:.1f})'" if turned else ""
        self.parts.append(
            f"<text x='{x:.1f}' y='{y:.1f}' text-anchor='{anchor}' font-size='{size:g}' fill='{colour}' {FONT}{turn}>"
            f"{escape(text)}</text>"
        )

    def __str__(self) -> str:
        head = f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {self.width:g} {self.height:g}' "
        size = f"width='{self.width:g}' height='{self.height:g}'>"
        return "\n".join([head + size, *self.parts, "</svg>\n"])
