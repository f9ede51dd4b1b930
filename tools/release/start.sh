#!/bin/sh
# The panel, with the brace that is plugged in or a simulated knee. Its window stays if there was an error.
cd "$(dirname "$0")" || exit
./crepitus panel --or-sim --sessions my-lessons "$@" || {
    echo "Enter / Eingabetaste"
    read -r _
}
