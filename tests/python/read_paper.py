"""Reads PDFs with pypdf, and draws them with PDFium.

    python read_paper.py REPORT.pdf...

Prints one JSON object: the title of each file. For each page it has the text, width and height in points, and the
share of pixels that are not white. Exit code 77 if a package is missing.
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
    """Returns the share of the pixels that are not white."""
    bitmap = page.render(scale=0.5)
    # Rows may be longer than the width of the page.
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
