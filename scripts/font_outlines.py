# SPDX-License-Identifier: BSD-3-Clause
"""Writes the outlines of a TrueType font's letters as a C++ table, for modules/render/src/text.

    python3 scripts/font_outlines.py /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf modules/render/src/text/glyphs.cpp

Letters: ASCII and what numbers and units need. Outlines are paths as in SVG, "M x y L x y x y Q cx cy x y", in font
units, y upwards, each back to its beginning; hints and kerning are left out. Needs python3 alone. The font's licence (DejaVu: LICENSE.dejavu beside
the table) goes for the table, too.
"""
import struct
import sys

LETTERS = [chr(c) for c in range(0x20, 0x7f)] + list("°±²³µ·¹ÅΩ×⁰⁴⁵⁶⁷⁸⁹⁻−μ")
COLUMNS = 96


class Font:
    def __init__(self, path):
        with open(path, "rb") as file:
            self.data = file.read()
        count = struct.unpack(">H", self.data[4:6])[0]
        self.tables = {}
        for i in range(count):
            tag, _, offset, _ = struct.unpack(">4sIII", self.data[12 + 16 * i:28 + 16 * i])
            self.tables[tag.decode()] = offset
        self.units = self.read("head", 18, "H")[0]
        self.long_offsets = self.read("head", 50, "h")[0]
        self.num_advances = self.read("hhea", 34, "H")[0]

    def read(self, table, offset, layout):
        """Big-endian numbers at an offset of a table."""
        at = self.tables[table] + offset
        return struct.unpack_from(">" + layout, self.data, at)

    def glyph_of(self, letter):
        """The glyph's number, by a character map of format 4."""
        tables = self.read("cmap", 2, "H")[0]
        for i in range(tables):
            _, _, offset = self.read("cmap", 4 + 8 * i, "HHI")
            if self.read("cmap", offset, "H")[0] == 4:
                break
        else:
            raise ValueError("the font has no character map of format 4")
        segments = self.read("cmap", offset + 6, "H")[0] // 2
        code, base = ord(letter), offset + 14
        for i in range(segments):
            if code > self.read("cmap", base + 2 * i, "H")[0]:
                continue
            first = self.read("cmap", base + 2 + 2 * segments + 2 * i, "H")[0]
            if code < first:
                return 0
            delta = self.read("cmap", base + 2 + 4 * segments + 2 * i, "H")[0]
            at = base + 2 + 6 * segments + 2 * i
            skip = self.read("cmap", at, "H")[0]
            if skip == 0:
                return (code + delta) & 0xffff
            return self.read("cmap", at + skip + 2 * (code - first), "H")[0]
        return 0

    def advance(self, glyph):
        return self.read("hmtx", 4 * min(glyph, self.num_advances - 1), "H")[0]

    def contours(self, glyph):
        """Lists of (x, y, is on the curve)."""
        if self.long_offsets:
            begin, end = self.read("loca", 4 * glyph, "II")
        else:
            begin, end = (2 * offset for offset in self.read("loca", 2 * glyph, "HH"))
        if begin == end:
            return []
        count = self.read("glyf", begin, "h")[0]
        return self.simple(begin + 10, count) if count >= 0 else self.composite(begin + 10)

    def simple(self, at, count):
        ends = self.read("glyf", at, f"{count}H")
        at += 2 * count
        at += 2 + self.read("glyf", at, "H")[0]
        flags = []
        while len(flags) <= ends[-1]:
            flag = self.read("glyf", at, "B")[0]
            at += 1
            repeats = 1
            if flag & 8:
                repeats += self.read("glyf", at, "B")[0]
                at += 1
            flags += [flag] * repeats
        axes = []
        for short, same in ((2, 16), (4, 32)):
            value, values = 0, []
            for flag in flags:
                if flag & short:
                    step = self.read("glyf", at, "B")[0]
                    value += step if flag & same else -step
                    at += 1
                elif not flag & same:
                    value += self.read("glyf", at, "h")[0]
                    at += 2
                values.append(value)
            axes.append(values)
        points = [(x, y, bool(flag & 1)) for x, y, flag in zip(*axes, flags)]
        return [points[begin:end + 1] for begin, end in zip((0,) + tuple(e + 1 for e in ends[:-1]), ends)]

    def composite(self, at):
        contours, more = [], True
        while more:
            flags, glyph = self.read("glyf", at, "HH")
            at += 4
            if not flags & 2:
                raise ValueError("parts placed by points are not read")
            dx, dy = self.read("glyf", at, "hh" if flags & 1 else "bb")
            at += 4 if flags & 1 else 2
            scale = (1.0, 0.0, 0.0, 1.0)
            if flags & 8:
                s = self.read("glyf", at, "h")[0] / 16384
                scale, at = (s, 0.0, 0.0, s), at + 2
            elif flags & 64:
                sx, sy = (value / 16384 for value in self.read("glyf", at, "hh"))
                scale, at = (sx, 0.0, 0.0, sy), at + 4
            elif flags & 128:
                scale, at = tuple(value / 16384 for value in self.read("glyf", at, "hhhh")), at + 8
            a, b, c, d = scale
            for contour in self.contours(glyph):
                contours.append([(round(a * x + c * y) + dx, round(b * x + d * y) + dy, on) for x, y, on in contour])
            more = bool(flags & 32)
        return contours


def middle(a, b):
    return (a[0] + b[0]) / 2, (a[1] + b[1]) / 2


def number(value):
    return str(round(value))


def path_of(contours):
    """Two neighbours off the curve have a point on it between them."""
    path = []
    for points in contours:
        on = next((i for i, point in enumerate(points) if point[2]), None)
        if on is None:
            start, rest = middle(points[-1], points[0]), points
        else:
            start, rest = points[on][:2], points[on + 1:] + points[:on]
        path += ["M", number(start[0]), number(start[1])]
        control, last = None, "M"
        for x, y, is_on in rest + [(*start, True)]:
            if control is not None:
                end = (x, y) if is_on else middle(control, (x, y))
                path += ["Q"] * (last != "Q") + [number(value) for value in (*control, *end)]
                last = "Q"
            elif is_on and (x, y) != start:
                path += ["L"] * (last != "L") + [number(x), number(y)]
                last = "L"
            control = None if is_on else (x, y)
    return " ".join(path)


def wrapped(text):
    lines, line = [], ""
    for word in text.split(" "):
        if len(line) + len(word) + 1 > COLUMNS:
            lines.append(line)
            line = ""
        line += word + " "
    return lines + [line.rstrip()]


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: python3 scripts/font_outlines.py FONT.ttf OUT.cpp")
    font = Font(sys.argv[1])
    rows = []
    for letter in sorted(LETTERS):
        glyph = font.glyph_of(letter)
        if glyph == 0:
            sys.exit(f"{sys.argv[1]} has no letter '{letter}'; take another font")
        head = f"    {{0x{ord(letter):04x}, {font.advance(glyph)},"
        lines = wrapped(path_of(font.contours(glyph)))
        rows.append("\n".join([head] + [f'     "{line}"' for line in lines]) + "},")
    with open(sys.argv[2], "w", encoding="utf-8") as out:
        out.write("// SPDX-License-Identifier: BSD-3-Clause\n"
                  "// Made by scripts/font_outlines.py from DejaVu Sans. LICENSE.dejavu beside this file is the\n"
                  "// licence of the outlines.\n"
                  '#include "text/text.h"\n\n'
                  "namespace pcl_slim::detail {\n\n"
                  f"const double kUnitsPerEm = {font.units};\n\n"
                  "// clang-format off\n"
                  "const Glyph kGlyphs[] = {\n" + "\n".join(rows) + "\n};\n"
                  "// clang-format on\n\n"
                  "const std::size_t kNumGlyphs = sizeof kGlyphs / sizeof kGlyphs[0];\n\n"
                  "}  // namespace pcl_slim::detail\n")


main()
