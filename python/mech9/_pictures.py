"""Pictures: shown by a notebook, and saved to files."""
from __future__ import annotations

import base64
import html
import os
import re
import tempfile
from typing import Callable

from ._errors import UsageError

# endings of names that tell programs how to read a picture
KINDS_OF_PICTURES = ('.svg', '.html', '.gif', '.mp4', '.png', '.jpg', '.jpeg', '.webp', '.pdf', '.eps')


class Picture:
    """A drawing or a film as the text of its file. A notebook shows it; `save` writes it."""

    def __init__(self, content: bytes, kind: str):
        self.content = content
        self.kind = kind   # svg, html, gif or mp4

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the picture to a file, whose name may end with its kind, as .svg, and not with that of another picture."""
        end = os.path.splitext(os.fspath(path))[1].lower()
        if end in KINDS_OF_PICTURES and end != f'.{self.kind}':
            raise UsageError(f'this picture is of the kind {self.kind}; give a name that ends with .{self.kind}, not with {end}', 2)
        with open(path, 'wb') as file:
            file.write(self.content)

    @property
    def text(self) -> str:
        """The text of an SVG or HTML file."""
        return self.content.decode('utf-8')

    def _repr_html_(self) -> str:
        if self.kind == 'svg':
            # several drawings in one page must not bear the same ids, to which nothing in them refers
            return re.sub(r' id="[^"]*"', '', self.text[self.text.index('<svg'):])
        if self.kind == 'gif':
            return f'<img src="data:image/gif;base64,{base64.b64encode(self.content).decode()}">'
        if self.kind == 'mp4':
            return f'<video controls loop src="data:video/mp4;base64,{base64.b64encode(self.content).decode()}"></video>'
        return (f'<iframe srcdoc="{html.escape(self.text, quote=True)}" style="width:100%;height:560px;border:0" '
                'sandbox="allow-scripts"></iframe>')

    def __repr__(self) -> str:
        return f'<mech9.Picture: {self.kind}, {len(self.content)} bytes>'


def drawn(draw: Callable[[bytes], None], kind: str) -> Picture:
    """The picture that a call draws in a file of a kind."""
    with tempfile.TemporaryDirectory(prefix='mech9_') as folder:
        path = os.path.join(folder, 'picture.' + kind)
        draw(os.fsencode(path))
        with open(path, 'rb') as file:
            return Picture(file.read(), kind)
