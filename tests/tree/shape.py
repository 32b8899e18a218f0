"""Refuses functions that are too long or too branched, assignments joined by commas, and jumps hidden in macros.

    shape.py [--except PREFIX]... FILE...    lists what is wrong, exits with 1 if anything is
    shape.py --list FILE...                  prints every function: lines, branches, name, place

Lines are counted from the one with the function's name to the one with its closing brace, all included.
Branches are McCabe's cyclomatic number (A complexity measure, 1976), as pmccabe and lizard count it: 1, and 1 for each
of if, for, while, case, ?:, && and ||. `default` and `else` add nothing.
A comma joins assignments where a statement outside a for's parentheses has an assignment, ++ or -- and a comma outside
of all parentheses: `a = 1, b = 2;`, `return n++, 0;`. Declarations may name several variables.
A macro hides a jump if its text outside of whole functions has return, goto, break or continue. A macro that is a whole
function is checked like any other one; the rest of a macro's text has the limit on branches.
"""
import re
import sys

MOST_LINES = 60
MOST_BRANCHES = 20

TOKEN = re.compile(
    r"""/\*.*?\*/ | //[^\n]*
      | "(?:\\.|[^"\\\n])*" | '(?:\\.|[^'\\\n])+'
      | [A-Za-z_]\w* | \.?\d(?:[eEpP][+-]|[\w.])*
      | <<= | >>= | -> | \+\+ | -- | && | \|\| | [-+*/%&|^=!<>]= | << | >> | \S""",
    re.S | re.X,
)
DIRECTIVE = re.compile(r"(?m)^[ \t]*#(?:/\*.*?\*/|[^\n\\]|\\.|\\\n)*", re.S)
DEFINE = re.compile(r"[ \t]*#[ \t]*define[ \t]+(\w+)(\([^)]*\))?")
BRANCHES = {"if", "for", "while", "case", "?", "&&", "||"}
ASSIGNMENTS = {"=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>=", "++", "--"}
JUMPS = {"return", "goto", "break", "continue"}
HEADS = {"if", "for", "while", "switch"}
TYPES = {"const", "static", "volatile", "register", "unsigned", "signed", "struct", "enum", "union", "typedef"}
TYPES |= {"void", "char", "short", "int", "long", "float", "double", "_Static_assert", "_Alignas"}
BEFORE_EXPRESSION = {"return", "case", "goto", "sizeof"}


class Token:
    def __init__(self, text, line):
        self.text = text
        self.line = line


def tokens_of(text, line=1):
    found = []
    at = 0
    for match in TOKEN.finditer(text):
        line += text.count("\n", at, match.start())
        at = match.start()
        if not match.group().startswith(("/*", "//")):
            found.append(Token(match.group(), line))
    return found


def split_macros(text):
    """The text without its preprocessor lines, and each macro as (name, its text, line)."""
    macros = []

    def blank(match):
        define = DEFINE.match(match.group())
        if define:
            body = match.group()[define.end() :].replace("\\\n", "\n")
            line = text.count("\n", 0, match.start()) + match.group().count("\n", 0, define.end()) + 1
            macros.append((define.group(1), body, line))
        return "\n" * match.group().count("\n")

    return DIRECTIVE.sub(blank, text), macros


def closing(tokens, at, step=1):
    """The index of the bracket that belongs to the one at `at`; None if there is none."""
    opening, depth = "([{" if step > 0 else ")]}", 0
    while 0 <= at < len(tokens):
        if tokens[at].text in ("(", "[", "{", ")", "]", "}"):
            depth += 1 if tokens[at].text in opening else -1
            if depth == 0:
                return at
        at += step
    return None


def name_before(tokens, at):
    """The name of the function whose body begins with the brace at `at`; None: something else begins there."""
    start = closing(tokens, at - 1, -1) if at and tokens[at - 1].text == ")" else None
    if not start or tokens[start - 1].text in HEADS:
        return None
    return tokens[start - 1]


def split_functions(tokens, where):
    """(name, line of its name, its body) of each function, and the tokens outside of functions."""
    functions, rest = [], []
    at = 0
    while at < len(tokens):
        if tokens[at].text != "{":
            rest.append(tokens[at])
            at += 1
            continue
        end = closing(tokens, at)
        if end is None:
            raise ValueError(f"{where}:{tokens[at].line}: a brace that does not close")
        is_extern_c = at > 1 and tokens[at - 2].text == "extern"
        if is_extern_c:
            inner, outer = split_functions(tokens[at + 1 : end], where)
            functions += inner
            rest += outer
        elif name_before(tokens, at):
            name = name_before(tokens, at)
            functions.append((name.text, name.line, tokens[at : end + 1]))
        else:
            rest += tokens[at : end + 1]
        at = end + 1
    return functions, rest


def branches_of(tokens):
    return 1 + sum(token.text in BRANCHES for token in tokens)


def is_declaration(statement):
    words = [token.text for token in statement[:3]] + ["", ""]
    if words[0] in TYPES:
        return True
    is_name = [bool(re.match(r"[A-Za-z_]", word)) for word in words]
    return is_name[0] and words[0] not in BEFORE_EXPRESSION and (is_name[1] or words[1] == "*")


def joined(statement):
    """The line of a comma that joins assignments; None."""
    while statement and statement[0].text in HEADS | {"else", "do", "case", "default"}:
        if statement[0].text in HEADS:
            start = (closing(statement, 1) if len(statement) > 1 else None) or len(statement)
        elif statement[0].text in ("case", "default"):
            start = next((i for i, token in enumerate(statement) if token.text == ":"), len(statement))
        else:
            start = 0
        statement = statement[start + 1 :]
    if is_declaration(statement):
        return None
    depth, comma, assigns = 0, None, False
    for token in statement:
        if token.text in ("(", "[", "{"):
            depth += 1
        elif token.text in (")", "]", "}"):
            depth -= 1
        elif depth == 0 and token.text == ",":
            comma = comma or token.line
        elif depth == 0 and token.text in ASSIGNMENTS:
            assigns = True
    return comma if assigns else None


def joined_assignments(body):
    """The lines of a function's body on which assignments are joined."""
    found, start, at = [], 1, 1
    while at < len(body):
        text = body[at].text
        if text in ("(", "["):
            at = closing(body, at) or at
        elif text == "{" and (body[at - 1].text in ("=", ",") or (body[at - 1].text == ")" and at > start and
                              body[start].text not in HEADS | {"else"})):
            at = closing(body, at) or at  # a value in braces, not a block
        elif text in ("{", "}", ";"):
            line = joined(body[start:at]) if text == ";" else None
            if line:
                found.append(line)
            start = at + 1
        at += 1
    return found


def functions_of(path, text):
    """Every function, of the file and of its macros: (name, first line, last line, body); and the macros' rest."""
    plain, macros = split_macros(text)
    functions = split_functions(tokens_of(plain), path)[0]
    rests = []
    for name, body, line in macros:
        inner, rest = split_functions(tokens_of(body, line), path)
        functions += [(f"{name}: {function}", first, tokens) for function, first, tokens in inner]
        rests.append((name, line, rest))
    return [(name, first, body[-1].line, body) for name, first, body in functions], rests


def faults_of(path, text):
    functions, rests = functions_of(path, text)
    for name, first, last, body in functions:
        lines, branches = last - first + 1, branches_of(body)
        if lines > MOST_LINES:
            yield first, f"{name} has {lines} lines, and {MOST_LINES} is the limit"
        if branches > MOST_BRANCHES:
            yield first, f"{name} has {branches} branches, and {MOST_BRANCHES} is the limit"
        for line in joined_assignments(body):
            yield line, f"{name} joins assignments by a comma"
    for name, line, rest in rests:
        if branches_of(rest) > MOST_BRANCHES:
            yield line, f"macro {name} has {branches_of(rest)} branches, and {MOST_BRANCHES} is the limit"
        jump = next((token for token in rest if token.text in JUMPS), None)
        if jump:
            yield jump.line, f"macro {name} hides a {jump.text}"


def main(arguments):
    exempt, files, is_list = [], [], False
    while arguments:
        word = arguments.pop(0)
        if word == "--except":
            exempt.append(arguments.pop(0))
        elif word == "--list":
            is_list = True
        else:
            files.append(word)
    functions, faults = 0, 0
    for path in files:
        with open(path, encoding="utf-8") as file:
            text = file.read()
        every = functions_of(path, text)[0]
        functions += len(every)
        for name, first, last, body in every if is_list else []:
            print(f"{last - first + 1:3} {branches_of(body):3} {name} {path}:{first}")
        if not is_list and not path.startswith(tuple(exempt)):
            for line, fault in faults_of(path, text):
                print(f"{path}:{line}: {fault}")
                faults += 1
    if not is_list:
        print(f"shape.py: {functions} functions in {len(files)} files, {faults} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
