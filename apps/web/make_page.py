"""make_page.py OUT.html FILES...: puts a page's parts into one file.

The .html among FILES has the marks {{style}}, {{script}} and {{modules}}. The .css files replace the first, the .js
files in their order the second, and the .wasm files, as constants in base64, the third."""
import base64
import pathlib
import sys


def main():
    out, parts = pathlib.Path(sys.argv[1]), [pathlib.Path(name) for name in sys.argv[2:]]
    text = {suffix: "".join(p.read_text() for p in parts if p.suffix == suffix) for suffix in (".html", ".css", ".js")}
    if "</script" in text[".js"]:
        sys.exit("make_page.py: a script that contains </script would end there")
    modules = "".join(f'const {p.stem.upper()} = "{base64.b64encode(p.read_bytes()).decode()}";\n'
                      for p in parts if p.suffix == ".wasm")
    page = text[".html"]
    for mark, content in (("{{style}}", text[".css"]), ("{{modules}}", modules), ("{{script}}", text[".js"])):
        if page.count(mark) != 1:
            sys.exit(f"make_page.py: {mark} is not there once")
        page = page.replace(mark, content)
    out.write_text(page)


main()
