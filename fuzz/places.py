#!/usr/bin/env python3
"""Which places of the source a target's corpus reaches, and which it has not reached before.

    fuzz/places.py build                    the program that counts; after a change of the source it begins anew
    fuzz/places.py new TARGET FOLDER...     reads files that it has not read yet; how many places are new to it,
                                            and how many of them no target had reached
    fuzz/places.py left TARGET              places that no file reached, of functions of which one did

A place is a region of the source as the compiler counts it: a function, a loop, an arm, a
condition. A generic function has its places once, however many rungs or effects it is built
for, so that what one rung reached is nothing new with another. Those of the product count, not the targets'.

Needs `rustup component add llvm-tools`. What was read and reached is kept in GROWN, which is
target/fuzz-grown if it is not set.
"""
import json, os, pathlib, shutil, subprocess, sys, tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
GROWN = pathlib.Path(os.environ.get("GROWN", ROOT / "target/fuzz-grown"))
BUILD = ROOT / "target/fuzz-places"
REPLAY = BUILD / "release/examples/replay"
# Of kinds of regions, those of code.
CODE = 0


def built():
    before = REPLAY.read_bytes() if REPLAY.exists() else b""
    # Build scripts count, too, and would write where they are started.
    counts = str(BUILD / "build-%p.profraw")
    flags = {"RUSTFLAGS": "-C instrument-coverage", "CARGO_INCREMENTAL": "0", "LLVM_PROFILE_FILE": counts}
    command = ["cargo", "build", "--release", "--example", "replay"]
    subprocess.run([*command, "--target-dir", BUILD], check=True, cwd=ROOT / "fuzz", env=os.environ | flags)
    if REPLAY.read_bytes() != before:
        shutil.rmtree(GROWN / "places", ignore_errors=True)


def tool(name):
    sysroot = subprocess.check_output(["rustc", "--print", "sysroot"], cwd=ROOT, text=True).strip()
    return next(pathlib.Path(sysroot).glob(f"lib/rustlib/*/bin/{name}"))


def reached(target, files):
    """The places of the functions that `files` reach: True if they reach the place, too."""
    with tempfile.TemporaryDirectory() as folder:
        raw, data = (pathlib.Path(folder) / name for name in ("raw", "data"))
        names = "".join(f"{file}\n" for file in files)
        environment = os.environ | {"LLVM_PROFILE_FILE": str(raw)}
        subprocess.run([REPLAY, target], input=names, text=True, check=True, env=environment)
        subprocess.run([tool("llvm-profdata"), "merge", "-sparse", raw, "-o", data], check=True)
        export = [tool("llvm-cov"), "export", "-instr-profile", data, REPLAY]
        functions = json.loads(subprocess.check_output(export))["data"][0]["functions"]
    places = {}
    for function in functions:
        for *region, count, file, _, kind in function["regions"]:
            path = pathlib.Path(function["filenames"][file])
            is_ours = path.is_relative_to(ROOT) and not path.is_relative_to(ROOT / "fuzz")
            if function["count"] and is_ours and kind == CODE:
                place = f"{path.relative_to(ROOT)}:{region[0]}:{region[1]}-{region[2]}:{region[3]}"
                places[place] = places.get(place, False) or count > 0
    return places


def state(target):
    file = GROWN / "places" / f"{target}.json"
    return file, json.loads(file.read_text()) if file.exists() else {"read": [], "places": {}}


def known():
    """The places that any target has reached."""
    states = (json.loads(file.read_text()) for file in (GROWN / "places").glob("*.json"))
    return {place for one in states for place, is_reached in one["places"].items() if is_reached}


def new(target, folders):
    file, before = state(target)
    read = set(before["read"])
    files = {path.name: path for folder in folders for path in sorted(pathlib.Path(folder).iterdir())}
    unread = {name: path for name, path in files.items() if name not in read}
    places = before["places"]
    found, new_to_all = [], []
    if unread:
        before_all = known()
        for place, is_reached in reached(target, unread.values()).items():
            if is_reached and not places.get(place):
                found.append(place)
            places[place] = places.get(place, False) or is_reached
        new_to_all = [place for place in found if place not in before_all]
        file.parent.mkdir(exist_ok=True)
        temporary = file.with_suffix(".new")
        temporary.write_text(json.dumps({"read": sorted(read | unread.keys()), "places": places}))
        temporary.replace(file)
    for place in found:
        print(place, *["new to all"] * (place in new_to_all), file=sys.stderr)
    print(len(found), sum(places.values()), len(places), len(new_to_all))


def left(target):
    _, now = state(target)
    print(*sorted(place for place, is_reached in now["places"].items() if not is_reached), sep="\n")


match sys.argv[1:]:
    case ["build"]:
        built()
    case ["new", target, *folders] if folders:
        new(target, folders)
    case ["left", target]:
        left(target)
    case _:
        sys.exit(__doc__)
