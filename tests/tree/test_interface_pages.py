"""The pages of the interfaces for C and Python are made from the code as it is."""
from interface_pages import C_PAGE, PYTHON_PAGE, c_page, python_page
from mech9_cases import text_of


def test_pages(checks):
    remedy = 'python3 tests/scripts/interface_pages.py writes it anew'
    checks.true(text_of(C_PAGE) == c_page(), f'docs/reference/c.md is that of mech9.h; {remedy}')
    checks.true(text_of(PYTHON_PAGE) == python_page(), f'docs/reference/python.md is that of the package; {remedy}')
