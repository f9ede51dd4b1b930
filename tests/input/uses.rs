//! Every argument of the program that has a value: the use of those that name a file, and the
//! placeholders of others.

/// Use of an argument that names a file.
pub(super) enum Use {
    /// Arguments of a command with every kind of file at `{}`; `{ok}` is a recording, `{out}` a new folder.
    Every(&'static str),
    /// Arguments of a command that shares its reader with others: with the endless kinds only.
    Endless(&'static str),
    /// Arguments of a command that says in its own way what is wrong: it has to end.
    Ends(&'static str),
    /// A file or folder that is written; `outputs` has the tests of these.
    Written,
}

use Use::{Endless, Ends, Every, Written};

/// Every argument that names a file, by verb and flag, or by verb and placeholder.
pub(super) const USES: &[(&str, Use)] = &[
    ("accuracy --out", Written),
    ("accuracy --scene", Every("accuracy --scene {} --out {out}")),
    (
        "arm --scene",
        Endless("arm --device sim --scene {} --for 1s"),
    ),
    ("bring-up --out", Written),
    (
        "bring-up --scene",
        Ends("bring-up --yes --device sim --scene {} --out {out}"),
    ),
    ("calibrate --out", Written),
    (
        "calibrate --scene",
        Endless("calibrate --yes --device sim --scene {} --out {out}"),
    ),
    (
        "clear-fault --scene",
        Endless("clear-fault --device sim --scene {}"),
    ),
    ("demo --out", Written),
    ("disarm --scene", Endless("disarm --device sim --scene {}")),
    ("doctor --scene", Ends("doctor --device sim --scene {}")),
    ("effects --out", Written),
    ("effects SCENE", Every("effects {} --out {out}")),
    ("experiment delete STUDY", Ends("experiment delete {} P1")),
    ("experiment evidence STUDY", Ends("experiment evidence {}")),
    ("experiment export --out", Written),
    (
        "experiment export STUDY",
        Ends("experiment export {} P1 --out {out}"),
    ),
    ("experiment new FILE", Written),
    (
        "experiment results STUDY",
        Ends("experiment results {} --out {out}"),
    ),
    ("experiment results --out", Written),
    (
        "experiment --scene",
        Endless("experiment run {abx} --study {out} --participant P1 --device sim --scene {}"),
    ),
    (
        "experiment run PROTOCOL",
        Every("experiment run {} --study {out} --participant P1 --device sim"),
    ),
    ("experiment run --study", Written),
    ("export --out", Written),
    ("export FILE", Every("export {} --format csv --out {out}")),
    ("fit --out", Written),
    ("fit --scene-out", Written),
    ("fit FILE", Every("fit {} --out {out}")),
    ("identify --out", Written),
    ("identify --scene-out", Written),
    (
        "identify RECORDINGS",
        Every("identify {} --weight-kg 1 --lever-m 0.2 --out {out}"),
    ),
    (
        "identify-actuator --from",
        Every("identify-actuator --from {} --moving-mass-g 50 --out {out}"),
    ),
    (
        "identify-actuator --from-added",
        Every("identify-actuator --from {csv} --from-added {} --added-mass-g 9 --out {out}"),
    ),
    ("identify-actuator --out", Written),
    (
        "identify-actuator --scene",
        Endless("identify-actuator --device sim --scene {} --moving-mass-g 50 --out {out}"),
    ),
    ("info --scene", Every("info --device sim --scene {}")),
    ("knee --out", Written),
    ("laws --out", Written),
    (
        "monitor --scene",
        Ends("monitor --device sim --scene {} --for 1s"),
    ),
    ("panel --experiments", Written),
    ("panel --replay", Every("panel --replay {}")),
    ("panel --scene", Endless("panel --device sim --scene {}")),
    ("panel --sessions", Written),
    (
        "params --scene",
        Endless("params get --device sim --scene {}"),
    ),
    (
        "params apply NAME|FILE",
        Every("params apply {} --device sim"),
    ),
    ("params backup FILE", Written),
    (
        "params diff NAME|FILE",
        Every("params diff {} --device sim"),
    ),
    (
        "params restore FILE",
        Every("params restore {} --device sim"),
    ),
    (
        "record --scene",
        Endless("record {out} --device sim --scene {} --for 1s"),
    ),
    ("record FILE", Written),
    ("report --out", Written),
    (
        "report --overlay",
        Every("report {ok} --overlay {} --out {out}"),
    ),
    ("report --wav", Written),
    ("report FILE", Every("report {} --out {out}")),
    ("run --out", Written),
    (
        "run --overlay",
        Every("run fig6-ideal-cycle --set duration_s=0.1 --overlay {} --out {out}"),
    ),
    ("run --wav", Written),
    ("run SCENE", Every("run {} --out {out}")),
    (
        "serve-sim --scene",
        Every("serve-sim --scene {} --name bad-files"),
    ),
    ("stability --out", Written),
    ("stop --scene", Endless("stop --device sim --scene {}")),
    (
        "stream --scene",
        Endless("stream --device sim --scene {} --for 1s"),
    ),
    ("sweep --again", Ends("sweep --again {} --out {out}")),
    ("sweep --merge", Ends("sweep --merge {} --out {out}")),
    ("sweep --out", Written),
    (
        "sweep --points",
        Every("sweep fig6-ideal-cycle --points {} --out {out}"),
    ),
    (
        "sweep SCENE",
        Every("sweep {} --vary duration_s=0.1,0.2 --out {out}"),
    ),
    ("vibration --out", Written),
    ("vibration SCENE", Every("vibration {} --out {out}")),
    ("zero --scene", Endless("zero --device sim --scene {}")),
];

/// Placeholders of values that name no file. A new one has to be put here or above.
pub(super) const NO_FILES: &[&str] = &[
    "%",
    "ADDR:PORT",
    "ADDRESS",
    "COLUMN",
    "CONVENTION",
    "DEG",
    "DEVICE",
    "EFFECT",
    "FACTOR",
    "FAULT",
    "FEEL",
    "FORMAT",
    "G",
    "HZ",
    "I/N",
    "KG",
    "KG_M2",
    "KIND",
    "LANGUAGE",
    "LEVEL",
    "LIST",
    "M",
    "N",
    "NAME",
    "NAME=VALUE",
    "NEED",
    "NM_PER_A",
    "OURS=FACTOR",
    "OURS=THEIRS",
    "OURS=VALUE",
    "PATH=VALUE",
    "PATH=VALUES",
    "PERCENT",
    "PARTICIPANT",
    "PORT",
    "PRECISION",
    "PSEUDONYM",
    "S",
    "SECONDS",
    "SEED",
    "SEVERITY",
    "SHELL",
    "SOURCE",
    "STEP",
    "TARGET",
    "TIME",
    "TITLE",
    "TOLERANCE",
    "UNIT",
    "V",
    "WAV_OF",
    "DISORDER",
    "one|two",
    "COMMAND",
    "ROW",
];
