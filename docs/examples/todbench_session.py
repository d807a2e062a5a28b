# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what todbench writes: session folders, recordings (.todrec), and --json. Needs numpy and nothing else.

    session = todbench_session.read_session("session-20261122T090000Z-demo")
    session.curve["s75_mrad"], session.verdict["decision"]
    for frame in todbench_session.read_recording("camera.todrec"):
        frame.kelvin().mean()

Formats: reference/session-folder.md and reference/recordings.md of todbench. A session whose files are not those of its manifest is refused.
"""
import csv
import hashlib
import json
import struct
import subprocess
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np


class Refused(Exception):
    """What was read is not what todbench wrote; the text says which file and why."""


def read_table(path):
    """A CSV file as {column: array}: numbers where every field is one or empty (nan), else text."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    if not rows:
        raise Refused(f"{path}: no header")
    if any(len(row) != len(rows[0]) for row in rows):
        raise Refused(f"{path}: rows of unequal length")
    columns = {}
    for place, name in enumerate(rows[0]):
        fields = [row[place] for row in rows[1:]]
        try:
            columns[name] = np.array([float(field) if field else np.nan for field in fields])
        except ValueError:
            columns[name] = np.array(fields)
    return columns


def changed_files(folder):
    """Files of the manifest that are missing or have other bytes; None where a run was cut off and left no manifest."""
    folder = Path(folder)
    if not (folder / "manifest.json").exists():
        return None
    changed = []
    for entry in json.loads((folder / "manifest.json").read_text(encoding="utf-8"))["files"]:
        file = folder / entry["path"]
        if not file.is_file() or hashlib.sha256(file.read_bytes()).hexdigest() != entry["sha256"]:
            changed.append(entry["path"])
    return changed


@dataclass
class Session:
    folder: Path
    trials: dict  # columns of trials.csv
    targets: dict  # columns of targets.csv; empty in a session of an early version
    curve: dict  # columns of curve.csv; empty where the run ended before its fit
    verdict: dict  # verdict.json, or None
    provenance: dict  # provenance.json

    def of_side(self, side):
        """The curve of 'measured' or 'simulated', contrast decreasing."""
        chosen = self.curve["side"] == side
        return {name: column[chosen] for name, column in self.curve.items()}


def read_session(folder, accept_changed=False):
    """A session folder, after its manifest."""
    folder = Path(folder)
    changed = changed_files(folder)
    if changed is None and not accept_changed:
        raise Refused(f"{folder}: no manifest.json: no session, or one that was cut off")
    if changed and not accept_changed:
        raise Refused(f"{folder}: changed after the run: {', '.join(changed)}")

    def table(name):
        return read_table(folder / name) if (folder / name).exists() else {}

    def document(name):
        return json.loads((folder / name).read_text(encoding="utf-8")) if (folder / name).exists() else None

    return Session(folder, table("trials.csv"), table("targets.csv"), table("curve.csv"), document("verdict.json"),
                   document("provenance.json"))


def kelvin_of(counts, scale):
    """Counts as temperatures, by the `scale` of a recording; nan where the scale does not reach."""
    counts = np.asarray(counts, dtype=float)
    kind = scale["kind"]
    if kind == "linear":
        return scale["offset_k"] + scale["kelvin_per_count"] * counts
    if kind == "table":
        return np.interp(counts, scale["counts"], scale["temperature_k"], left=np.nan, right=np.nan)
    if kind == "planck":
        signal = np.where(counts > scale["o"], counts - scale["o"], np.nan)
        with np.errstate(invalid="ignore"):
            return scale["b"] / np.log(scale["r"] / signal + scale["f"])
    raise Refused(f"a scale of kind '{kind}' has no temperatures")


@dataclass
class RecordedFrame:
    counts: np.ndarray  # 16 bits, rows from the top
    sequence: int  # a gap is a lost frame
    device_time_ns: int  # clock of the camera; 0: none
    host_time_ns: int  # monotonic clock of the host
    since_correction_s: float  # negative: the camera does not say
    complete: bool  # False: never measured
    correcting: bool  # during a correction of the non-uniformity
    camera: dict  # of the header, with its scale

    def kelvin(self):
        return kelvin_of(self.counts, self.camera["scale"])


FRAME = struct.Struct("<QqqdHHBBBB")


def records_of(path):
    """(kind, payload, whether the payload is whole) of every record up to the first that was cut off."""
    with open(path, "rb") as file:
        if file.read(8) != b"TODBREC1":
            raise Refused(f"{path}: no recording of todbench")
        size = Path(path).stat().st_size
        while len(start := file.read(16)) == 16:
            kind, length, of_start, of_payload = struct.unpack("<4sIII", start)
            if zlib.crc32(start[:8]) != of_start or length > size - file.tell():
                return
            payload = file.read(length)
            yield kind, payload, zlib.crc32(payload) == of_payload


def read_recording(path):
    """The frames of a recording, one after the other. A frame with a flipped bit is not complete."""
    camera = None
    for kind, payload, whole in records_of(path):
        if kind == b"HEAD":
            if not whole:
                raise Refused(f"{path}: the header is damaged")
            header = json.loads(payload)
            if header["schema"] != "todbench-recording-1":
                raise Refused(f"{path}: schema {header['schema']}, expected todbench-recording-1")
            camera = header["camera"]
        elif kind == b"FRAM" and camera is not None and len(payload) >= FRAME.size:
            (sequence, device, host, since, width, height, status, correction, _, _) = FRAME.unpack_from(payload)
            if len(payload) != FRAME.size + 2 * width * height:
                continue
            counts = np.frombuffer(payload, "<u2", offset=FRAME.size).reshape(height, width)
            yield RecordedFrame(counts, sequence, device, host, since, whole and status == 0, correction == 2, camera)


def run_json(*arguments, program="todbench"):
    """The object that `todbench ARGUMENTS --json` prints. Exit codes 0, 1 and 3 are results; others raise with its sentence."""
    ended = subprocess.run([program, *map(str, arguments), "--json", "--quiet"], capture_output=True, text=True, check=False)
    if ended.returncode not in (0, 1, 3):
        raise Refused(ended.stderr.strip())
    return json.loads(ended.stdout)
