#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs every command of docs/guide/first-hour.md, in order, in one empty folder: first_hour_test.py PROGRAM WINDOW SOURCES PICTURES.

The window is shown on an X server where xvfb-run is installed; the pictures of its pages are left in the folder PICTURES.

Also here: a long table goes through the pager of a terminal. Exit code 77: what is not there is said.
"""
import os
import pathlib
import pty
import re
import shutil
import subprocess
import sys
import tempfile

# 1 and 3 are verdicts of a measurement, not faults of a command.
VERDICTS = {"todbench measure": (0, 1, 3), "todbench compare": (0, 1, 3), "todbench simulate": (0, 1, 3)}


def commands_of(page):
    """The commands of all boxes; a here-document belongs to its command."""
    for box in re.findall(r"^```sh\n(.*?)^```", page, re.M | re.S):
        lines = iter(box.splitlines())
        for line in lines:
            command = line
            if "<<'END'" in line:
                for more in lines:
                    command += "\n" + more
                    if more == "END":
                        break
            yield command


def allowed(command):
    return next((codes for start, codes in VERDICTS.items() if command.startswith(start)), (0,))


def walk(page, folder, environment):
    ran = 0
    for command in commands_of(page):
        done = subprocess.run(["sh", "-c", command], cwd=folder, env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, stdin=subprocess.DEVNULL)
        if done.returncode not in allowed(command):
            print(f"{command}\n{done.stdout}\nexit code {done.returncode}")
            return None
        ran += 1
    return ran


def is_paged(folder, environment, rows):
    """Whether the table of the cameras, three lines or more, went to the pager of a terminal of so many lines."""
    paged = pathlib.Path(folder, f"paged-{rows}.txt")
    ours, theirs = pty.openpty()
    subprocess.run(["stty", "rows", str(rows), "cols", "200"], stdin=theirs, check=True)
    done = subprocess.Popen(["todbench", "devices"], cwd=folder, stdin=theirs, stdout=theirs, stderr=theirs,
                            env={**environment, "PAGER": f"cat > {paged}"})
    os.close(theirs)
    shown = b""
    try:
        while some := os.read(ours, 4096):
            shown += some
    except OSError:  # the end of a terminal
        pass
    done.wait()
    os.close(ours)
    went = paged.is_file() and "sim:sc2000" in paged.read_text(encoding="utf-8")
    return went and b"sim:sc2000" not in shown


def put_window(tools, window):
    """`todbench-gui` on an X server of its own; without one the environment says that there is no screen."""
    name = tools / "todbench-gui"
    if not shutil.which("xvfb-run"):
        name.symlink_to(window)
        return "offscreen"
    name.write_text(f'#!/bin/sh\nexec xvfb-run -a -s "-screen 0 1366x768x24" "{window}" "$@"\n', encoding="utf-8")
    name.chmod(0o755)
    return "xcb"


def main():
    program, window, sources, pictures = sys.argv[1:5]
    page = pathlib.Path(sources, "docs/guide/first-hour.md").read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        tools = pathlib.Path(folder, "bin")
        tools.mkdir()
        (tools / "todbench").symlink_to(program)
        screen = put_window(tools, window) if window else "offscreen"
        environment = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "QT_QPA_PLATFORM": screen,
                       "HOME": folder, "NO_COLOR": "1"}
        work = pathlib.Path(folder, "work")
        work.mkdir()
        if not window:
            page = re.sub(r"^(todbench-gui|ls pictures).*$", "true", page, flags=re.M)
        ran = walk(page, work, environment)
        if (work / "pictures").is_dir():
            shutil.copytree(work / "pictures", pictures, dirs_exist_ok=True)
        if ran is None:
            return 1
        wanted = ["unit-1/report.html", "curve/verdict.json", "mine.toml"]
        wanted += ["pictures/start.png", "pictures/plan.png", "pictures/report.png"] if window else []
        for name in wanted:
            if not (work / name).is_file():
                print(name, "was not made")
                return 1
        report = (work / "unit-1/report.html").read_text(encoding="utf-8")
        for text in ("Example Laboratory", "Statement of the laboratory"):
            if text not in report:
                print("the report lacks", text)
                return 1
        if not is_paged(work, environment, 3) or is_paged(work, environment, 100):
            print("a table is paged where it is longer than the terminal, and only there")
            return 1
    print(f"{ran} commands" + (f", the window on {screen}" if window else ", without the window, which was not built"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
