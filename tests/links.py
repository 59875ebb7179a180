"""Where Markdown leads, as a reader sees it who has no build of the manual."""

import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).parent.parent
TRACKED = subprocess.run(
    ["git", "ls-files"], cwd=ROOT, check=True, capture_output=True, text=True
).stdout.splitlines()


def seen(text):
    """What a reader sees without a build: no comments, no blocks."""
    text = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)


def targets(text):
    """Links and images within what a reader sees, but those of the web."""
    text = re.sub(r"`[^`\n]*`", "", seen(text))
    linked = re.findall(r"\]\(([^)\s]+)\)", text) + re.findall(r'(?:src|href)="([^"]+)"', text)
    return [target for target in linked if not target.startswith(("http:", "https:"))]


def anchors(text):
    """Headings as forges name them, and anchors in HTML."""
    titles = re.findall(r"^#+ (.*)$", seen(text), re.MULTILINE)
    plain = (re.sub(r"<[^>]*>", "", title).strip().lower() for title in titles)
    slugs = {re.sub(r"[^\w\- ]", "", title).replace(" ", "-") for title in plain}
    return slugs | set(re.findall(r'<a id="([^"]+)">', text))


def leads(page, target):
    """Whether a link of a page leads to a file that git tracks, and there to what it names."""
    name, _, anchor = target.partition("#")
    file = ((ROOT / page).parent / name).resolve() if name else ROOT / page
    if not file.is_relative_to(ROOT) or file.relative_to(ROOT).as_posix() not in TRACKED:
        return False
    return not anchor or anchor in anchors(file.read_text(encoding="utf-8"))


def dead(page, text):
    """Links of a page that lead nowhere in a checkout."""
    return [target for target in targets(text) if not leads(page, target)]
