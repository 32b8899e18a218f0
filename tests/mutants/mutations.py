"""What can be changed in a C file that is laid out by .clang-format, one change each: see mutants.py.

    mutations.py FILE...    lists all of them
"""
import dataclasses
import re
import sys

TOKEN = re.compile(
    r"""/\*.*?\*/ | //[^\n]*
      | ^[ \t]*\#[ \t]*(?:include|ifn?def|endif|else|undef|error)[^\n]*
      | "(?:\\.|[^"\\\n])*" | '(?:\\.|[^'\\\n])+'
      | [A-Za-z_]\w* | \.?\d(?:[eEpP][+-]|[\w.])*
      | <<= | >>= | -> | \+\+ | -- | && | \|\| | [-+*/%&|^=!<>]= | << | >> | \S""",
    re.S | re.X | re.M,
)
SWAPS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "+": "-", "-": "+", "*": "/", "/": "*",
         "&&": "||", "||": "&&", "&": "|", "|": "&", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "<<": ">>",
         ">>": "<<"}
TYPE = re.compile(r"(double|float|int|char|void|const|static|struct|enum|typedef|size_t|u?int\d+_t|\w+_t|pupil_\w+)$")
KEYWORDS = {"if", "else", "for", "while", "do", "switch", "case", "default", "return", "break", "continue", "goto",
            "sizeof", "typedef", "static", "const", "enum", "struct", "union", "extern"}


@dataclasses.dataclass(frozen=True)
class Mutation:
    kind: str
    start: int  # in the text
    end: int
    before: str
    after: str


def tokens_of(text):
    found = [(m[0], m.start(), m.end()) for m in TOKEN.finditer(text)]
    return [t for t in found if not t[0].startswith(("/*", "//", '"')) and not t[0].lstrip().startswith("#include")
            and not re.match(r"[ \t]*#[ \t]*(ifn?def|endif|else|undef|error)", t[0])]


def is_binary(text, start, end):
    """Operators with two operands have a space on both sides; pointers and signs do not."""
    return text[start - 1] in " \n" and text[end] in " \n"


def numbers(token):
    """What a constant is changed to."""
    if re.fullmatch(r"\d+[uUlL]*", token):
        digits, suffix = re.fullmatch(r"(\d+)([uUlL]*)", token).groups()
        n = int(digits)
        return [f"{v}{suffix}" for v in (n + 1, n - 1) if v >= 0]
    if re.fullmatch(r"0[xX][0-9a-fA-F]+[uUlL]*|'.*", token):
        return []
    return [f"({token} * 2)", f"({token} * 0.5)"] if float_of(token) else [f"({token} + 1)"]


def float_of(token):
    value = token.rstrip("fFlL")
    try:
        return float.fromhex(value) if value.lower().startswith("0x") else float(value)
    except ValueError:
        return 0.0


def closing(tokens, i):
    """The index of the parenthesis that closes the one at i."""
    depth = 0
    for j in range(i, len(tokens)):
        depth += {"(": 1, ")": -1}.get(tokens[j][0], 0)
        if depth == 0:
            return j
    return len(tokens) - 1


def is_array_size(tokens, i):
    """A number in brackets after a name in its declaration."""
    if tokens[i - 1][0] != "[" or i < 3:
        return False
    j = i - 2
    while j > 0 and tokens[j][0] == "]":  # a second dimension
        while tokens[j][0] != "[":
            j -= 1
        j -= 1
    return bool(TYPE.match(tokens[j - 1][0])) or tokens[j - 1][0] == "*" and bool(TYPE.match(tokens[j - 2][0]))


def of_statement(text, tokens, i):
    """The mutations of the whole statement that begins at token i."""
    word, start, _ = tokens[i]
    if word in ("if", "while") and tokens[i + 1][0] == "(":
        j = closing(tokens, i + 1)
        inside = text[tokens[i + 1][2] : tokens[j][1]]
        return [Mutation("condition", tokens[i + 1][2], tokens[j][1], inside, f"!({inside})")]
    depth, j = 0, i
    while j < len(tokens) and (depth or tokens[j][0] not in (";", "{", "}")):
        depth += {"(": 1, "{": 1, "[": 1, ")": -1, "}": -1, "]": -1}.get(tokens[j][0], 0)
        j += 1
    if j >= len(tokens) or tokens[j][0] != ";":
        return []
    whole = text[start : tokens[j][1]]
    if word == "return" and j > i + 1:
        value = text[tokens[i + 1][1] : tokens[j][1]]
        return [Mutation("return", tokens[i + 1][1], tokens[j][1], value, "1" if value == "0" else "0")]
    names = [t[0] for t in tokens[i : i + 2]]
    is_declared = re.match(r"[A-Za-z_]\w*[ *]+[A-Za-z_]", whole) or word in KEYWORDS
    if re.match(r"[A-Za-z_*(]", word) and not is_declared and len(names) == 2 and names[1] != ":":
        return [Mutation("deletion", start, tokens[j][1], whole, "")]
    return []


def function_depths(tokens):
    """For each token, whether it is in a function's body: braces that follow a closing parenthesis."""
    inside, depth, was = [], 0, ""
    for word, _, _ in tokens:
        if word == "{" and (depth or was == ")"):
            depth += 1
        inside.append(depth > 0)
        if word == "}" and depth:
            depth -= 1
        was = word
    return inside


def mutations_of(text):
    tokens, found = tokens_of(text), []
    inside = function_depths(tokens)
    begins = True  # a statement does, at this token
    ends_of_heads = set()
    for i, (word, start, end) in enumerate(tokens):
        if begins and inside[i] and word not in "{};":
            found += of_statement(text, tokens, i)
        if word in ("if", "for", "while", "switch") and i + 1 < len(tokens) and tokens[i + 1][0] == "(":
            ends_of_heads.add(closing(tokens, i + 1))
        begins = word in ("{", "}", ";", "else", "do") or i in ends_of_heads
        in_define = text[text.rfind("\n", 0, start) + 1 :].startswith("#define")
        if word in SWAPS and (inside[i] or in_define) and is_binary(text, start, end):
            kind = "comparison" if word in ("<", "<=", ">", ">=", "==", "!=") else "operator"
            found.append(Mutation(kind, start, end, word, SWAPS[word]))
        if re.match(r"\.?\d", word) and not is_array_size(tokens, i):
            found += [Mutation("constant", start, end, word, after) for after in numbers(word)]
    return found


def line_of(text, mutation):
    return text.count("\n", 0, mutation.start) + 1


def source_line(text, mutation):
    return " ".join(text.splitlines()[line_of(text, mutation) - 1].split())


def mutated(text, mutation):
    return text[: mutation.start] + mutation.after + text[mutation.end :]


def is_of_extreme(text, m):
    """Whether it changes a < b ? a : b or the like to <=: which of two equal values is taken makes no difference,
    except for the sign of 0."""
    if m.before not in ("<", "<=", ">", ">="):
        return False
    head = " ".join(re.split(r"[;{}]", text[: m.start])[-1].split())
    tail = " ".join(text[m.end : text.find(";", m.end)].split())
    found = re.match(r"([^?;{}]+) \? ([^:;{}]+) : ([^;{}]+)", tail)
    if not found or re.fullmatch(r"0(\.0f?)?", found[1]):
        return False
    right, first, second = found.groups()
    if first == right:
        left = next((second[:n] for n in range(len(second), 0, -1) if head.endswith(second[:n])), "")
        left = left if re.match(r"[,)]|$", second[len(left) :]) else ""
    else:
        left = first if re.match(re.escape(right) + r"([,)]|$)", second) else ""
    return bool(left) and head.endswith(left) and bool(re.search(r"([=(,?:]|&&|\|\||return) ?$", head[: -len(left)]))


if __name__ == "__main__":
    for name in sys.argv[1:]:
        with open(name) as file:
            whole = file.read()
        for m in mutations_of(whole):
            print(f"{name}:{line_of(whole, m)}: {m.kind}: {' '.join(m.before.split())} -> {' '.join(m.after.split())}")
