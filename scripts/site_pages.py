"""Hook of mkdocs.yml: README.md becomes the index page, and pages and files outside docs/ join the site.

Links in Markdown lead to files of the repository. On the site, docs/NAME is NAME, README.md is index.md, and every other
file keeps its path; links are rewritten accordingly. A page is added if it is in the navigation, a file if a page links to
it. A notebook docs/NAME.ipynb with its outputs is the page NAME.md.
"""

import os
import posixpath
import re

from mkdocs.structure.files import File
from nbconvert import MarkdownExporter

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
LINK = re.compile(r"\[([^\[\]]*)\]\(([^)\s]+)\)")


def repository_path(place):
    """Returns the path in the repository of a path on the site."""
    if place == "index.md":
        return "README.md"
    notebook = f"docs/{place.removesuffix('.md')}.ipynb"
    if os.path.exists(os.path.join(ROOT, notebook)):
        return notebook
    return place if os.path.exists(os.path.join(ROOT, place)) else f"docs/{place}"


def site_path(path):
    """Returns the path on the site of a path in the repository."""
    if path.endswith(".ipynb"):
        path = path.removesuffix(".ipynb") + ".md"
    return "index.md" if path == "README.md" else path.removeprefix("docs/")


def notebook_files(config, path):
    """Returns the page of a notebook with its outputs, and the pictures of the page."""
    exporter = MarkdownExporter()
    pictures = posixpath.basename(path).removesuffix(".ipynb")
    markdown, resources = exporter.from_filename(
        os.path.join(ROOT, path), resources={"output_files_dir": pictures, "unique_key": "output"}
    )
    page = site_path(path)
    yield File.generated(config, page, content=markdown)
    for name, content in resources["outputs"].items():
        yield File.generated(config, posixpath.join(posixpath.dirname(page), name), content=content)


def target(page, link):
    """Returns the path in the repository that a link on a page leads to, and its anchor; None for other links."""
    path, _, anchor = link.partition("#")
    if not path or ":" in path or path.startswith("/"):
        return None
    path = posixpath.normpath(posixpath.join(posixpath.dirname(page), path))
    if os.path.isfile(os.path.join(ROOT, path, "README.md")):
        path = f"{path}/README.md"
    return (path, anchor) if os.path.exists(os.path.join(ROOT, path)) else None


def pages_of(nav):
    """Returns all pages of the navigation."""
    for entry in nav:
        for value in entry.values():
            yield from [value] if isinstance(value, str) else pages_of(value)


def on_files(files, config):
    def add(path):
        place = site_path(path)
        if path.endswith(".ipynb") and place not in files.src_uris:
            for file in notebook_files(config, path):
                files.append(file)
        elif place not in files.src_uris:
            files.append(File.generated(config, place, abs_src_path=os.path.join(ROOT, path)))

    pages = [repository_path(place) for place in pages_of(config.nav)]
    for page in pages:
        add(page)
    for page in pages:
        with open(os.path.join(ROOT, page), encoding="utf-8") as file:
            links = LINK.findall(file.read())
        for path, _ in filter(None, (target(page, link) for _, link in links)):
            if os.path.isfile(os.path.join(ROOT, path)):
                add(path)
    return files


def on_page_markdown(markdown, page, config, files):
    here = repository_path(page.file.src_uri)

    def rewrite(match):
        found = target(here, match[2])
        if found is None:
            return match[0]
        path, anchor = found
        if os.path.isdir(os.path.join(ROOT, path)):
            return match[1]
        place = posixpath.relpath(site_path(path), posixpath.dirname(page.file.src_uri) or ".")
        return f"[{match[1]}]({place}{'#' if anchor else ''}{anchor})"

    return LINK.sub(rewrite, markdown)


def on_page_content(html, page, config, files):
    # A table in Markdown escapes a vertical bar in code as `\|`.
    return re.sub(r"<td><code>[^<]*</code>", lambda match: match[0].replace(r"\|", "|"), html)
