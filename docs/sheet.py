#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Pictures beside each other, as one: the sheet of a page.

    python3 docs/sheet.py OUT.png COLUMNS PICTURE.png ...

PNGs of 8 bits red, green and blue, as `render` writes them, all of one size.  Nothing is scaled.
"""
import struct
import sys
import zlib


def read(path):
    """(width, rows of bytes)"""
    data = open(path, 'rb').read()
    at, packed = 8, b''
    while at < len(data):
        length, kind = struct.unpack('>I4s', data[at:at + 8])
        chunk = data[at + 8:at + 8 + length]
        if kind == b'IHDR':
            width, height, depth, colours = struct.unpack('>IIBB', chunk[:10])
            if (depth, colours) != (8, 2):
                sys.exit(f'{path}: not of 8 bits red, green and blue')
        packed += chunk if kind == b'IDAT' else b''
        at += 12 + length
    raw, before, rows = zlib.decompress(packed), bytes(3 * width), []
    for y in range(height):
        kind, *row = raw[y * (3 * width + 1):(y + 1) * (3 * width + 1)]
        for i in range(len(row)):
            a, b, c = row[i - 3] if i >= 3 else 0, before[i], before[i - 3] if i >= 3 else 0
            near = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            row[i] = row[i] + (0, a, b, (a + b) // 2, near)[kind] & 255
        before = bytes(row)
        rows.append(before)
    return width, rows


def write(path, width, rows):
    def chunk(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))

    lines, before = [], bytes(3 * width)
    for row in rows:  # the difference from above packs better than the bytes
        lines.append(b'\2' + bytes((a - b) & 255 for a, b in zip(row, before)))
        before = row
    with open(path, 'wb') as out:
        out.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', width, len(rows), 8, 2, 0, 0, 0)) +
                  chunk(b'IDAT', zlib.compress(b''.join(lines), 9)) + chunk(b'IEND', b''))


def main(out, columns, *files):
    columns, pictures = int(columns), [read(f) for f in files]
    if len({(width, len(rows)) for width, rows in pictures}) != 1:
        sys.exit('pictures of different sizes')
    width, rows = pictures[0]
    blank = (width, [b'\xff' * (3 * width)] * len(rows))
    pictures += [blank] * (-len(pictures) % columns)
    write(out, width * columns, [b''.join(p[1][y] for p in pictures[i:i + columns])
                                 for i in range(0, len(pictures), columns) for y in range(len(rows))])


if __name__ == '__main__':
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
