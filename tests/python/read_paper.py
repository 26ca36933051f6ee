"""Reads PDFs with pypdf, and draws them with PDFium.

    python read_paper.py REPORT.pdf...

Prints one JSON object: by file the title, and by page its text, width and height in points, and the share of the drawn page that isn't
white. Exit code 77 where a package is absent.
"""
import json
import sys

try:
    import pypdf
    import pypdfium2
except Exception as e:
    print(f"absent: {e}")
    sys.exit(77)


def inked(page):
    """Share of the pixels that aren't white."""
    bitmap = page.render(scale=0.5)
    # Rows may be longer than the page is wide.
    width = bitmap.width * bitmap.n_channels
    data = bytes(bitmap.buffer)
    rows = (data[i * bitmap.stride : i * bitmap.stride + width] for i in range(bitmap.height))
    white = sum(row[::bitmap.n_channels].count(255) for row in rows)
    return 1 - white / (bitmap.width * bitmap.height)


def read(path):
    reader = pypdf.PdfReader(path)
    drawn = pypdfium2.PdfDocument(path)
    pages = [
        {
            "text": page.extract_text(),
            "size": [float(page.mediabox.width), float(page.mediabox.height)],
            "inked": inked(drawn[i]),
        }
        for i, page in enumerate(reader.pages)
    ]
    return {"title": reader.metadata.title, "pages": pages}


print(json.dumps({path: read(path) for path in sys.argv[1:]}))
