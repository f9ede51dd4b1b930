# What every part of the sweep runs: one place for what is varied.
# Usage: sh sweep.sh [more arguments of `crepitus sweep`]
exec "${CREPITUS:-crepitus}" sweep knee-pass-frozen \
    --vary effects.crepitus.stiffness_nm_per_rad=100:800:log20 \
    --vary effects.crepitus.static_torque_nm=0.35:0.5:lin10 \
    "$@"
