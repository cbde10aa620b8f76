"""A small reader and writer of good data files (namelist groups), for tests that change mechanisms.

It knows what the data files of the tests use and no more: groups &name ... /, items name = values and
name(i,:) = values, text in single quotes, comments after '!'. A list of (group, {name: values}); names
are in lower case, values are lists of float, int, bool or str.
"""
import re

TOKEN = re.compile(r"'(?:[^']|'')*'|[^\s,=]+|=|,")


def strip_comments(text):
    lines = []
    for line in text.splitlines():
        quoted = False
        for i, letter in enumerate(line):
            if letter == "'":
                quoted = not quoted
            elif letter == '!' and not quoted:
                line = line[:i]
                break
        lines.append(line)
    return '\n'.join(lines)


def value_of(word):
    if word.startswith("'"):
        return word[1:-1].replace("''", "'")
    if word.lower() in ('.true.', '.false.'):
        return word.lower() == '.true.'
    try:
        return int(word)
    except ValueError:
        return float(word.lower().replace('d', 'e'))


def parse(text):
    """The groups of a data file, in its order."""
    text = strip_comments(text)
    groups = []
    for found in re.finditer(r"&(\w+)((?:'[^']*'|[^'/])*)/", text):
        items = {}
        # 'c(1,:)' is one word
        words = TOKEN.findall(re.sub(r'\((\d+),:\)', r'[\1]', found.group(2)))
        name = None
        for word, following in zip(words, words[1:] + ['']):
            if following == '=':
                name = word.lower()
                items[name] = []
            elif word not in ('=', ','):
                items[name].append(value_of(word))
        groups.append((found.group(1).lower(), items))
    return groups


def text_of(value):
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'"
    if isinstance(value, bool):
        return '.true.' if value else '.false.'
    if isinstance(value, int):
        return str(value)
    return repr(float(value))   # the shortest text that reads back the same


def write(groups):
    """The groups as the text of a data file."""
    text = ''
    for group, items in groups:
        text += f'&{group}\n'
        for name, values in items.items():
            name = re.sub(r'\[(\d+)\]', r'(\1,:)', name)
            text += f'  {name} = ' + ', '.join(text_of(value) for value in values) + '\n'
        text += '/\n'
    return text
