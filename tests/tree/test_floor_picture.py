"""The picture of the floors in docs/pictures shows which floor uses which."""
from floor_picture import DRAWING, PICTURE, arrows_of_drawing, arrows_of_picture, drawing
from mech9_cases import text_of


def test_drawing(checks, sources):
    checks.true(text_of(DRAWING) == drawing(sources), 'the drawing shows the floors and which floor uses which',
                'draw it anew: tests/scripts/floor_picture.py')


def test_picture(checks, sources):
    checks.equal(arrows_of_picture(PICTURE), arrows_of_drawing(drawing(sources)), 'the picture shows the arrows of the drawing')
