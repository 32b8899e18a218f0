#!/usr/bin/env python3
"""abi.py INCLUDE [COMPILER]: prints the ABI of the public headers in INCLUDE/pupil, as abi.txt has it: the size of each
struct with the offset, size and type of its fields, the values of enumerations and macros, and the functions.

The headers are read as the preprocessor leaves them. A small program, compiled with the same compiler, says the
offsets. A struct that has padding, or that neither begins with size_bytes nor is called frozen, is an error."""

import pathlib
import re
import subprocess
import sys
import tempfile


def preprocessed(compiler, include, options, text):
    command = [compiler, "-std=c11", "-E", *options, "-I", include, "-xc", "-"]
    return subprocess.run(command, input=text, capture_output=True, text=True, check=True).stdout


def own_lines(text, include):
    """The lines that come from the public headers, found by the preprocessor's line markers."""
    own = False
    for line in text.splitlines():
        marker = re.match(r'# \d+ "(.*?)"', line)
        if marker:
            own = marker.group(1).startswith(include + "/pupil/")
        elif own:
            yield line


def statements(text):
    """The declarations at file scope, one a line; of a function with a body only its head."""
    depth, current, in_function = 0, "", False
    for token in re.findall(r"[{};]|[^{};]+", text):
        if depth == 0 and (token == ";" or (token == "{" and current.rstrip().endswith(")"))):
            in_function = token == "{"
            if current.strip():
                yield " ".join(current.split())
            current = ""
        elif not in_function:
            current += token
        depth += (token == "{") - (token == "}")
        in_function = in_function and depth > 0


def fields_of(body):
    """(type, name) of each field; the lengths of an array are part of its type."""
    for declaration in filter(None, (d.strip() for d in body.split(";"))):
        first, *more = [d.strip() for d in declaration.split(",")]
        base, name = re.fullmatch(r"(.*?[ *])(\w+(?:\[[^;]*\])?)", first).groups()
        for declarator in [name, *more]:
            name, array = re.fullmatch(r"(\w+)(.*)", declarator).groups()
            yield (base.strip() + array.replace(" ", ""), name)


def without_names(function):
    """A function's head without the names of its parameters, which are not part of the ABI."""
    head, parameters = function.rstrip(")").split("(", 1)
    types = [re.sub(r"(?<=[ *])\w+(\[\w*\])?$", r"\1", p.strip()) for p in parameters.split(",")]
    return f"{head}({', '.join(t.strip() for t in types)})"


class Headers:
    def __init__(self, include, compiler):
        names = sorted(path.name for path in pathlib.Path(include, "pupil").glob("*.h"))
        self.include, self.compiler = include, compiler
        self.includes = "".join(f'#include "pupil/{name}"\n' for name in names)
        text = "\n".join(own_lines(preprocessed(compiler, include, [], self.includes), include))
        text = re.sub(r'extern "C"|__attribute__\(\(.*?\)\)\)?', "", text)
        self.structs, self.enumerators, self.functions, self.types = {}, [], [], []
        for statement in statements(text):
            self.take(statement)
        defines = own_lines(preprocessed(compiler, include, ["-dD"], self.includes), include)
        found = (re.match(r"#define (PUPIL_\w+) (.+)", line) for line in defines)
        self.macros = [m.groups() for m in found if m and not re.search(r"VERSION|_API$", m.group(1))]

    def take(self, statement):
        struct = re.fullmatch(r"typedef (struct|union) \w+ \{(.*)\} (\w+)", statement)
        enum = re.fullmatch(r"(?:typedef )?enum ?\w* \{(.*)\} ?\w*", statement)
        if struct:
            self.structs[struct.group(3)] = list(fields_of(struct.group(2)))
        elif enum:
            names = [value.split("=")[0].strip() for value in enum.group(1).split(",")]
            self.enumerators += list(filter(None, names))
        elif statement.startswith("typedef"):
            self.types.append(statement)
        else:
            self.functions.append(without_names(statement))

    def measured(self):
        """Sizes, offsets and values, printed by a program, as a dictionary. The keys are what is printed before the
        colon."""
        lines = [self.includes, "#include <stddef.h>", "#include <stdio.h>", "int main(void)", "{"]
        for struct, fields in self.structs.items():
            lines.append(f'printf("{struct}:%zu\\n", sizeof({struct}));')
            for _, name in fields:
                lines.append(f'printf("{struct}.{name}:%zu %zu\\n", offsetof({struct}, {name}), '
                             f"sizeof((({struct} *)0)->{name}));")
        for name in self.enumerators:
            lines.append(f'printf("{name}:%ld\\n", (long){name});')
        lines += ["return 0;", "}"]
        with tempfile.TemporaryDirectory() as folder:
            source, program = pathlib.Path(folder, "abi.c"), pathlib.Path(folder, "abi")
            source.write_text("\n".join(lines))
            subprocess.run([self.compiler, "-std=c11", "-I", self.include, str(source), "-o", str(program)], check=True)
            said = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout
        return dict(line.split(":") for line in said.splitlines())


def frozen(include):
    """The structs that their comment calls frozen."""
    text = "".join(path.read_text() for path in pathlib.Path(include, "pupil").glob("*.h"))
    return set(re.findall(r"Frozen:[^/]*\*/\ntypedef struct (\w+)", text))


def faults(headers, measured, include):
    excused = frozen(include)
    for struct, fields in headers.structs.items():
        end = 0
        for _, name in fields:
            offset, size = map(int, measured[f"{struct}.{name}"].split())
            if offset != end:
                yield f"{struct} has {offset - end} bytes of padding before {name}: name them reserved"
            end = offset + size
        if end != int(measured[struct]):
            yield f"{struct} has {int(measured[struct]) - end} bytes of padding at its end: name them reserved"
        is_object = fields[0][1] == "private_words"
        if fields[0] != ("uint32_t", "size_bytes") and struct not in excused and not is_object:
            yield f"{struct} does not begin with size_bytes, and its comment does not say \"Frozen:\" and why"


def main():
    include = sys.argv[1].rstrip("/")
    headers = Headers(include, sys.argv[2] if len(sys.argv) > 2 else "cc")
    measured = headers.measured()
    found = list(faults(headers, measured, include))
    for struct, fields in sorted(headers.structs.items()):
        print(f"{struct}: {measured[struct]} bytes")
        for kind, name in fields:
            offset, size = measured[f"{struct}.{name}"].split()
            print(f"{offset:>8} {size:>6} {kind} {name}")
    for title, lines in (("enumerators", [f"{name} = {measured[name]}" for name in headers.enumerators]),
                         ("macros", [f"{name} {value}" for name, value in headers.macros]),
                         ("types", headers.types), ("functions", headers.functions)):
        print(f"\n{title}")
        for line in sorted(lines) if title != "enumerators" else lines:
            print("    " + line)
    for fault in found:
        print(f"abi.py: {fault}", file=sys.stderr)
    return 1 if found else 0


sys.exit(main())
