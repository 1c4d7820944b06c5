"""Writes every preset file beside this folder, and removes files that no recipe makes any more."""

from pathlib import Path

from . import preset_files

FOLDER = Path(__file__).resolve().parent.parent

texts = preset_files()
for key, text in texts.items():
    (FOLDER / f"{key}.toml").write_text(text, encoding="utf-8", newline="\n")
for path in FOLDER.glob("*.toml"):
    if path.stem not in texts:
        path.unlink()
print(f"{len(texts)} presets written to {FOLDER}")
