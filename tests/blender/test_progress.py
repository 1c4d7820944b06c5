"""Lines of progress: one that is written over on a terminal, few elsewhere."""

import io

from nested_dielectric.scene.progress import ProgressLine


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_on_a_terminal_one_line_is_written_over_and_wiped_off():
    progress = ProgressLine(2, Terminal())
    for label in ("frame 1 (1 of 2)", "frame 2 (2 of 2)"):
        progress.begin(label)
        for done in (0, 1, 2):
            progress(done, 2)
        progress.end()
    text = progress.stream.getvalue()
    assert "\n" not in text and "frame 1 (1 of 2): 0 of 2 samples\r" in text
    assert "frame 2 (2 of 2): 1 of 2 samples, 0.0 s left" in text
    *_, last, wiped, end = text.split("\r")
    assert wiped == " " * len(wiped) and end == "" and len(last.rstrip()) <= len(wiped)


def test_elsewhere_a_single_picture_has_a_line_every_tenth_of_the_way():
    progress = ProgressLine(1, io.StringIO())
    for done in range(101):
        progress(done, 100)
    progress.end()
    lines = progress.stream.getvalue().splitlines()
    assert (
        len(lines) == 11 and lines[0] == "rendering: 0 of 100 samples" and lines[-1] == "rendering: 100 of 100 samples"
    )
    assert all(line.endswith(" left") for line in lines[1:-1])


def test_elsewhere_of_several_pictures_there_is_nothing_but_what_the_caller_prints():
    progress = ProgressLine(3, io.StringIO())
    progress.begin("frame 1 (1 of 3)")
    progress(0, 4)
    progress(4, 4)
    seconds, left = progress.end()
    assert progress.stream.getvalue() == "" and left == 2 * seconds
