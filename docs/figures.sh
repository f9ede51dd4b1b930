#!/bin/sh
# Makes every picture of the README and the book again.
set -eu
cd "$(dirname "$0")/.."
figure() { # SCENE CHART PICTURE
    cargo run --profile dist --features emulator --quiet -- run "$1" --set output.trace_step_s=5e-5 --pictures --out "target/figures/$1" >/dev/null
    cp "target/figures/$1/$2.svg" "docs/images/$3.svg"
    echo "docs/images/$3.svg"
}
figure slow-examination zoom-1 stick-slip-cycles
figure knee-pass-frozen torque knee-pass-frozen
figure knee-pass-physical torque knee-pass-physical
figure end-feel-capsular range-limit-1 disorder-end-feel
figure lead-pipe-examination lead-pipe-1 disorder-lead-pipe
figure cogwheel-examination cogwheel-2 disorder-cogwheel
figure spasticity-tardieu spasticity-2 disorder-spasticity
figure spasticity-catch-angles catch-angle disorder-catch-angles
figure clasp-knife-examination clasp-knife-1 disorder-clasp-knife
figure clonus-hold clonus-2 disorder-clonus
figure texture-there-and-back texture-1 disorder-texture

cargo run --profile dist --features emulator --quiet -- accuracy --target --all --pictures --out target/figures/accuracy >target/figures/accuracy.txt
for picture in frequency-f64 frequency-f32 tick-torque-f32; do
    measure=${picture%-*} precision=${picture##*-}
    image=docs/images/accuracy-${picture#tick-}.svg
    cp "target/figures/accuracy/$measure-constant-0-988-physical-$precision.svg" "$image"
    echo "$image"
done

cargo run --profile dist --features emulator --quiet -- laws --target --pictures --out target/figures/laws >target/figures/laws.txt
for picture in model-errors numerical-errors grating-cycles; do
    cp "target/figures/laws/$picture.svg" "docs/images/laws-$picture.svg"
    echo "docs/images/laws-$picture.svg"
done
# Its table in docs/friction-laws.md is that of the screen: compare them.
cat target/figures/laws.txt

cp target/figures/accuracy/cycles.csv host/studies/src/accuracy/target/cycles.csv
echo host/studies/src/accuracy/target/cycles.csv
for convention in frozen physical; do
    cp "target/figures/accuracy/target-constant-0-988-$convention-f32.svg" "docs/images/accuracy-target-$convention.svg"
    echo "docs/images/accuracy-target-$convention.svg"
done
# The tables go between their marks: each is what follows its heading.
awk 'NR == FNR { if (/^The other symptoms/) which = "symptoms"
                 if (/^The command of the vibration actuator/) which = "actuator"
                 if (/^A step on the target/) which = "target"
                 if (/^\|/) table[which] = table[which] $0 "\n"; next }
     /<!-- end of the table -->/ { printf "%s\n", table[inside]; inside = "" }
     inside == "" { print }
     /<!-- table of the target/ { inside = "target"; print "" }
     /<!-- table of the symptoms/ { inside = "symptoms"; print "" }' \
    target/figures/accuracy.txt docs/accuracy.md >target/figures/accuracy.md
cp target/figures/accuracy.md docs/accuracy.md
echo docs/accuracy.md

# Costs on recorded knees, where the recordings stand beside the repository.
if [ -d ../shared/data ]; then
    points=
    for knee in opencap_squat_100hz:7.9 opensim_walk_100hz:2.3 bmc_walk_150hz:1.1; do
        name=${knee%:*}
        for convention in frozen physical; do
            folder=target/figures/$name-$convention
            cat >"target/figures/$name.toml" <<SCENE
version = 1
title = "$name"
duration_s = ${knee#*:}
[motion]
kind = "recording"
file = "$PWD/../shared/data/$name.csv"
time_column = "time_s"
angle_column = "knee_flexion_deg"
[solver]
kind = "exact-events"
step_s = 5e-5
[effects.crepitus]
convention = "$convention"
SCENE
            cargo run --profile dist --features emulator --quiet -- accuracy --scene "target/figures/$name.toml" \
                --quick --force --out "$folder" >/dev/null
            points="$points $folder/points.csv"
        done
    done
    # shellcheck disable=SC2086
    awk -F, -f docs/recorded-costs.awk $points >docs/generated/recorded-costs.md
    echo docs/generated/recorded-costs.md
else
    echo "left out: docs/generated/recorded-costs.md, which needs the recordings" >&2
fi

cargo run --profile dist --features emulator --quiet -- stability --pictures --out target/figures/stability >/dev/null
cp target/figures/stability/matrix.svg docs/images/stability-matrix.svg
echo docs/images/stability-matrix.svg
for story in three-solvers implicit-euler restick-rules parameter-change turn-back-guard; do
    cp "target/figures/stability/$story.svg" "docs/images/$story.svg"
    echo "docs/images/$story.svg"
done
cargo run --profile dist --features emulator --quiet -- stability --coupled --all --pictures --out target/figures/coupled >target/figures/coupled.txt
cp target/figures/coupled/z-width.svg docs/images/z-width.svg
echo docs/images/z-width.svg
cargo run --profile dist --features emulator --quiet -- stability --list --long >docs/generated/hard-cases.md
echo docs/generated/hard-cases.md

# The numbers of the page about what the hand gets are what this prints.
cargo run --profile dist --features emulator --quiet -- vibration --draws 200 --pictures --out target/figures/vibration >target/figures/vibration.txt
cp target/figures/vibration/hand-spectrum.svg docs/images/hand-spectrum.svg
echo docs/images/hand-spectrum.svg

# The numbers of the page about effects are what these print.
for scene in fig8 fig9; do
    cargo run --profile dist --features emulator --quiet -- effects "$scene" --all --pictures --out "target/figures/effects-$scene"
    cp "target/figures/effects-$scene/build-up.svg" "docs/images/build-up-${scene%%-*}.svg"
    echo "docs/images/build-up-${scene%%-*}.svg"
done
cargo run --profile dist --features emulator --quiet -- effects tardieu-fast --out target/figures/effects-symptoms \
    --set effects.range-limit.flexion_limit_deg=75 --set effects.lead-pipe.torque_nm=1.2 --set effects.cogwheel.torque_nm=2 \
    --set effects.spasticity.form=catch --set effects.clasp-knife.onset_deg=30 --set effects.clonus.hold_deg=60 \
    --set effects.texture.pitch_deg=1.5

# The page about effects: what arrives behind which seat of the brace, by the Python package.
if python3 -c 'import crepitus, matplotlib' 2>/dev/null; then
    python3 python/examples/transmission.py target/figures >/dev/null
    cp target/figures/transmission.svg docs/images/transmission.svg
    echo docs/images/transmission.svg
else
    echo "left out: docs/images/transmission.svg, which needs Python: pip install ./python matplotlib" >&2
fi

# The page about sweeps: the indices of every parameter, by the Python package and SALib.
if python3 -c 'import crepitus, SALib, matplotlib' 2>/dev/null; then
    python3 python/examples/sensitivity.py target/figures 128 >/dev/null
    cp target/figures/sensitivity.svg docs/images/sensitivity.svg
    echo docs/images/sensitivity.svg
else
    echo "left out: docs/images/sensitivity.svg, which needs Python: pip install ./python SALib matplotlib" >&2
fi

# The page about figures for a paper: letters as outlines, so with the feature that has fonts. One run stands in for a
# measurement of another.
paper() {
    cargo run --profile dist --features pdf --quiet -- run slow-examination "$@"
}
paper --pictures --column one --out target/figures/paper >/dev/null
cp target/figures/paper/zoom-1.svg docs/images/paper-zoom.svg
echo docs/images/paper-zoom.svg
paper --set duration_s=0.4 --set effects.crepitus.convention=physical --out target/figures/stand-in --force >/dev/null
paper --set duration_s=0.4 --overlay target/figures/stand-in/trace.csv --overlay-columns torque_nm=torque_nm \
    --pictures --column one --out target/figures/overlay --force
cp target/figures/overlay/overlay.svg docs/images/paper-overlay.svg
echo docs/images/paper-overlay.svg
