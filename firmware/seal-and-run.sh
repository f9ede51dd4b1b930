#!/bin/sh
# The runner of `cargo run`: seals an image, flashes it, and shows its log.
set -eu
elf=$(realpath "$1")
# For the host, and of this workspace alone: nothing of the host's is built.
cd "$(dirname "$0")"
host=$(rustc -vV | sed -n 's/^host: //p')
cargo run --quiet --locked --package crepitus-firmware-seal --target "$host" -- "$elf"
# By default probe-rs halts the core at a hard fault and at every reset. The handler that switches
# the bridge off would then not run, and each restart that the firmware asks for would stop.
exec probe-rs run --chip STM32F405RGTx --no-catch-hardfault --no-catch-reset "$elf"
