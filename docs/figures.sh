#!/bin/sh
# Makes every picture of the README and the book again.
set -eu
cd "$(dirname "$0")/.."
figure() { # SCENE CHART PICTURE
    cargo run --release --quiet -- run "$1" --pictures --out "target/figures/$1" >/dev/null
    cp "target/figures/$1/$2.svg" "docs/images/$3.svg"
    echo "docs/images/$3.svg"
}
figure slow-examination zoom-1 stick-slip-cycles
figure knee-pass-frozen torque knee-pass-frozen
figure knee-pass-physical torque knee-pass-physical

cargo run --release --quiet -- accuracy --pictures --out target/figures/accuracy >/dev/null
for picture in frequency-f64 frequency-f32 torque-f32; do
    measure=${picture%-*} precision=${picture#*-}
    cp "target/figures/accuracy/$measure-constant-0-988-physical-$precision.svg" "docs/images/accuracy-$picture.svg"
    echo "docs/images/accuracy-$picture.svg"
done

cargo run --release --quiet -- stability --pictures --out target/figures/stability >/dev/null
cp target/figures/stability/matrix.svg docs/images/stability-matrix.svg
echo docs/images/stability-matrix.svg
for story in implicit-euler restick-rules parameter-change turn-back-guard; do
    cp "target/figures/stability/$story.svg" "docs/images/$story.svg"
    echo "docs/images/$story.svg"
done
cargo run --release --quiet -- stability --list --long >docs/hard-cases.md
echo docs/hard-cases.md

# The numbers of the page about effects are what these print.
for scene in fig8-5-hand fig9-low-speed; do
    cargo run --release --quiet -- effects "$scene" --pictures --out "target/figures/effects-$scene"
    cp "target/figures/effects-$scene/build-up.svg" "docs/images/build-up-${scene%%-*}.svg"
    echo "docs/images/build-up-${scene%%-*}.svg"
done
