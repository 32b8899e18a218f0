#!/usr/bin/env python3
"""generate.py INCLUDE OUTPUT.py MIRROR.c PLACE...: what the Python module has to know of the ABI.

OUTPUT.py gets the structs of the public headers as ctypes, the enumerations, the macros and the functions with their
types. MIRROR.c repeats each struct as it was understood here; the compiler, which knows the headers, refuses it where
an offset differs. Nothing is run that was built, so this works in a cross build too. PLACE: folders of the library, as
seen from the module's."""

import pathlib
import re
import sys

HEADERS = ("abi.h", "error.h", "coding.h", "image.h", "config.h", "stats.h", "pupil.h", "sensor.h")
SCALARS = {"char": "c_char", "uint8_t": "c_uint8", "uint16_t": "c_uint16", "uint32_t": "c_uint32",
           "uint64_t": "c_uint64", "int32_t": "c_int32", "int64_t": "c_int64", "int": "c_int",
           "float": "c_float", "double": "c_double", "size_t": "c_size_t", "ptrdiff_t": "c_ssize_t",
           "const char *": "c_char_p", "const char **": "POINTER(c_char_p)", "void *": "c_void_p", "void": "None",
           "const void *": "c_void_p", "float *": "POINTER(c_float)", "double *": "POINTER(c_double)",
           "uint32_t *": "POINTER(c_uint32)", "const float *": "POINTER(c_float)",
           "const double *": "POINTER(c_double)"}


def without_comments(text):
    return re.sub(r"/\*.*?\*/", " ", text, flags=re.S)


def words_of(comment):
    return " ".join(re.sub(r"\n\s*\*", " ", comment).split())


class Abi:
    def __init__(self, include):
        text = "\n".join(pathlib.Path(include, "pupil", name).read_text() for name in HEADERS)
        self.macros, self.enums, self.structs, self.functions = {}, {}, {}, {}
        for name, value in re.findall(r"^#define (PUPIL_\w+) +(.+)$", without_comments(text), re.M):
            value = value.strip().rstrip("u")
            if re.fullmatch(r"[-()\dxa-fA-F]+", value):
                self.macros[name] = int(value.strip("()"), 0)
        for kind, _, body, name in re.findall(r"typedef (enum|struct|union) (\w+) \{\n(.*?)\n\} (\w+);", text, re.S):
            if kind == "enum":
                self.enums[name] = self.members(without_comments(body))
            else:
                self.structs[name] = list(self.fields(body))
        self.errors = self.members(without_comments(re.search(r"\nenum \{(.*?)\n\};", text, re.S).group(1)))
        plain = without_comments(text)
        for result, name, parameters in re.findall(r"PUPIL_API ([\w ]+?\*?)(pupil_\w+)\(([^)]*)\);", plain):
            types = [] if parameters == "void" else [self.parameter(p) for p in parameters.split(",")]
            self.functions[name] = (self.type_of(result.strip()), types)

    @staticmethod
    def members(body):
        """(name, value) of each enumerator."""
        found, following = [], 0
        for member in filter(None, (m.strip() for m in body.split(","))):
            name, _, value = (part.strip() for part in member.partition("="))
            following = int(value, 0) if value else following
            found.append((name, following))
            following += 1
        return found

    def length(self, expression):
        names = {name: str(value) for name, value in self.macros.items()}
        expression = re.sub(r"PUPIL_\w+", lambda m: names[m.group(0)], expression)
        if not re.fullmatch(r"[\d /*]+", expression):
            sys.exit(f"generate.py: the length {expression} is not understood")
        return eval(expression.replace("/", "//"))

    def fields(self, body):
        """(C type, name, lengths, comment) of each field: the comment that follows it, after a paragraph before it; or
        the last paragraph, where none follows."""
        before, is_new = "", False
        for token in re.finditer(r"/\*(.*?)\*/|([^;/]+(?:/ ?\d+[^;]*)?);(?:[ \n]*/\*(.*?)\*/)?", body, re.S):
            if token.group(1) is not None:
                before, is_new = words_of(token.group(1)), True
                continue
            own = words_of(token.group(3) or "")
            is_head = is_new and len(before) > 40 and own  # shorter: the title of a group
            comment = f"{before.rstrip('.')}. {own}" if is_head else own or before
            is_new = False
            declaration = " ".join(token.group(2).split())
            base, rest = re.fullmatch(r"((?:const )?\w+ \*?)(.*)", declaration).groups()
            for declarator in rest.split(","):
                name, lengths = re.fullmatch(r" ?(\w+)((?:\[[^]]+\])*)", declarator).groups()
                yield base.strip(), name, [self.length(l) for l in re.findall(r"\[([^]]+)\]", lengths)], comment

    def type_of(self, c_type):
        struct = re.fullmatch(r"(?:const )?(pupil_\w+) \*", c_type)
        if struct:
            return f"POINTER({struct.group(1)})"
        return SCALARS[c_type] if c_type in SCALARS else c_type

    def parameter(self, text):
        base, name, array = re.fullmatch(r"(.*?[ *])(\w+)((?:\[\w*\])?)", " ".join(text.split())).groups()
        return self.type_of(base.strip() + (" *" if array else ""))


def python_type(abi, c_type, lengths):
    result = abi.type_of(c_type)
    for length in reversed(lengths):
        result = f"{result} * {length}" if " " not in result else f"({result}) * {length}"
    return result


def class_name(enum):
    return "".join(part.capitalize() for part in enum.split("_")[1:])


def enum_class(name, members):
    """The members without what all of them begin with."""
    kept = [(member, value) for member, value in members if not member.endswith("_COUNT")]
    first = kept[0][0].split("_")
    shared = 0
    while all(member.split("_")[: shared + 1] == first[: shared + 1] and len(member.split("_")) > shared + 1
              for member, _ in kept):
        shared += 1
    lines = [f"class {class_name(name)}(IntEnum):"]
    for member, value in kept:
        short = "_".join(member.split("_")[shared:])
        lines.append(f"    {'_' * short[0].isdigit()}{short} = {value}")
    return lines


def module(abi, places):
    version = [abi.macros[f"PUPIL_VERSION_{part}"] for part in ("MAJOR", "MINOR", "PATCH")]
    soname = f"libpupil.so.0.{version[1]}" if version[0] == 0 else f"libpupil.so.{version[0]}"
    lines = ['"""Generated from the public headers by drivers/python/generate.py."""', "from ctypes import *",
             "from enum import IntEnum", "", f"VERSION = {tuple(version)}", f"SONAME = {soname!r}",
             f"PLACES = {places!r}"]
    lines += [f"{name} = {value}" for name, value in abi.macros.items()]
    lines += [f"{name} = {value}" for name, value in abi.errors]
    for name, members in abi.enums.items():
        lines += [""] + enum_class(name, members)
    enum_of, about = {}, {}
    for struct, fields in abi.structs.items():
        lines += ["", f"class {struct}(Structure):", "    _fields_ = ["]
        for c_type, name, lengths, comment in fields:
            lines.append(f"        ({name!r}, {python_type(abi, c_type, lengths)}),")
            named = re.search(r"(?:^|\. )a (pupil_\w+)", comment)
            if named and named.group(1) in abi.enums and c_type == "uint32_t":
                enum_of[f"{struct}.{name}"] = class_name(named.group(1))
            about[f"{struct}.{name}"] = comment
        lines.append("    ]")
    lines += ["", "ENUM_OF = {"] + [f"    {key!r}: {value}," for key, value in enum_of.items()] + ["}"]
    lines += ["", "ABOUT = {"] + [f"    {key!r}: {value!r}," for key, value in about.items()] + ["}"]
    lines += ["", "FUNCTIONS = {"]
    lines += [f"    {name!r}: ({result}, [{', '.join(types)}])," for name, (result, types) in abi.functions.items()]
    return "\n".join(lines + ["}", ""])


def mirror(abi):
    lines = ["/* Generated by drivers/python/generate.py: it compiles where the structs are those of the headers. */",
             '#include "pupil/pupil.h"', '#include "pupil/sensor.h"', "#include <stddef.h>"]
    for struct, fields in abi.structs.items():
        lines.append(f"struct mirror_{struct} {{")
        for c_type, name, lengths, _ in fields:
            lines.append(f"    {c_type} {name}" + "".join(f"[{length}]" for length in lengths) + ";")
        lines.append("};")
        lines.append(f'_Static_assert(sizeof(struct mirror_{struct}) == sizeof({struct}), "{struct}");')
        for _, name, _, _ in fields:
            lines.append(f'_Static_assert(offsetof(struct mirror_{struct}, {name}) == offsetof({struct}, {name}) &&')
            lines.append(f'    sizeof(((struct mirror_{struct} *)0)->{name}) == sizeof((({struct} *)0)->{name}), '
                         f'"{struct}.{name}");')
    for name, value in [pair for members in list(abi.enums.values()) + [abi.errors] for pair in members]:
        lines.append(f'_Static_assert({name} == {value}, "{name}");')
    return "\n".join(lines + [""])


def main():
    include, output, mirrored, *places = sys.argv[1:]
    abi = Abi(include)
    pathlib.Path(output).write_text(module(abi, places))
    pathlib.Path(mirrored).write_text(mirror(abi))


main()
