"""Writes the pages of the interfaces for C and Python from their code: docs/reference/c.md and docs/reference/python.md.

usage: interface_pages.py      A test tells when the pages are out of date: tests/tree/test_interface_pages.py
"""
import ast
import os
import re

from mech9_cases import TREE, text_of

HEADER = os.path.join(TREE, 'include', 'mech9.h')
PACKAGE = os.path.join(TREE, 'python', 'mech9')
C_PAGE = os.path.join(TREE, 'docs', 'reference', 'c.md')
PYTHON_PAGE = os.path.join(TREE, 'docs', 'reference', 'python.md')


def c_page():
    """The header with an introduction."""
    return f'''# The interface for C and C++

This page shows `include/mech9.h` as it is. `examples/c` has two programs in C and one in C++. The library is built by `cmake --preset release -DMECH9_SHARED=ON`.
After its installation CMake finds it by `find_package(mech9)` as `mech9::c`, and other builds by `pkg-config --cflags --libs mech9`.

```c
{text_of(HEADER).rstrip()}
```
'''


def signature(function):
    """The arguments of a function as they are written, without self and annotations."""
    arguments = function.args
    shown = [argument.arg for argument in arguments.posonlyargs + arguments.args if argument.arg not in ('self', 'cls')]
    defaults = [ast.unparse(value) for value in arguments.defaults]
    for i, value in enumerate(defaults):
        shown[len(shown) - len(defaults) + i] += '=' + value
    if arguments.vararg:
        shown.append('*' + arguments.vararg.arg)
    elif arguments.kwonlyargs:
        shown.append('*')
    shown += [argument.arg + ('' if value is None else '=' + ast.unparse(value))
              for argument, value in zip(arguments.kwonlyargs, arguments.kw_defaults)]
    if arguments.kwarg:
        shown.append('**' + arguments.kwarg.arg)
    return '(' + ', '.join(argument for argument in shown if not argument.startswith('_')) + ')'


def words(node):
    """A docstring as text of a table."""
    return re.sub(r'\s+', ' ', (ast.get_docstring(node) or '').replace('|', '\\|'))


def members(node):
    """(name with arguments, docstring) of the public functions and properties of a class."""
    for item in node.body:
        if not isinstance(item, ast.FunctionDef) or not ast.get_docstring(item):
            continue
        is_property = any(isinstance(one, ast.Name) and one.id == 'property' for one in item.decorator_list)
        if item.name in ('__getitem__', '__setitem__', '__call__'):
            yield {'__getitem__': '[name]', '__setitem__': '[name] = value', '__call__': '(x)'}[item.name], words(item)
        elif not item.name.startswith('_'):
            yield '.' + item.name + ('' if is_property else signature(item)), words(item)


def python_page():
    """The public names of the package with their docstrings."""
    tree = {name: ast.parse(text_of(os.path.join(PACKAGE, name))) for name in sorted(os.listdir(PACKAGE)) if name.endswith('.py')}
    start = tree['__init__.py']
    shown = next(ast.literal_eval(item.value) for item in start.body if isinstance(item, ast.Assign) and item.targets[0].id == '__all__')
    found = {item.name: item for module in tree.values() for item in module.body if isinstance(item, (ast.FunctionDef, ast.ClassDef))}
    lines = ['# The Python package', '',
             'This page is made from the code of `python/mech9`; [eleven things in Python](../tutorials/python.md) shows how it is used.', '']
    functions = [name for name in shown if isinstance(found[name], ast.FunctionDef)]
    lines += ['| function | |', '| --- | --- |', *(f'| `mech9.{name}{signature(found[name])}` | {words(found[name])} |' for name in functions), '']
    for name in shown:
        if name in functions:
            continue
        lines += [f'## {name}', '', re.sub(r'\n\n+', '\n\n', ast.get_docstring(found[name]) or ''), '']
        rows = list(members(found[name]))
        if rows:
            lines += ['| | |', '| --- | --- |', *(f'| `{call}` | {meaning} |' for call, meaning in rows), '']
    return '\n'.join(lines)


if __name__ == '__main__':
    for path, page in ((C_PAGE, c_page()), (PYTHON_PAGE, python_page())):
        with open(path, 'w', encoding='utf-8') as file:
            file.write(page)
