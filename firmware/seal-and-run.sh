#!/bin/sh
# The runner of `cargo run`: seals an image, flashes it, and shows its log.
set -eu
elf=$(realpath "$1")
# From the root, whose settings are those of the host.
(cd "$(dirname "$0")/.." && cargo run --quiet --package crepitus-image -- seal "$elf")
exec probe-rs run --chip STM32F405RGTx "$elf"
