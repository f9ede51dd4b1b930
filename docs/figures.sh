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
