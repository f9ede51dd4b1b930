#!/usr/bin/env bash
# Fuzzes every target in turn, piece by piece, into corpora that outlive a run:
#
#   fuzz/grow.sh [TARGET...]           pieces for each target in turn, until stopped
#   fuzz/grow.sh status                the sums of the ledger
#   fuzz/grow.sh merge [TARGET...]     minimises into fuzz/corpus
#
# PIECE_S    seconds of a piece                              300
# ROUNDS     pieces for each target, then it ends            without end
# GROWN      folder of corpora, ledger, crashes, programs    target/fuzz-grown
# MOST_FILES files that a merge may leave in a corpus        200
set -euo pipefail
cd "$(dirname "$0")/.."

piece_s=${PIECE_S:-300} rounds=${ROUNDS:-1000000000} most_files=${MOST_FILES:-200}
grown=${GROWN:-$PWD/target/fuzz-grown}
ledger=$grown/ledger.tsv
targets=$(sed -n 's/^name = "\([a-z]*\)"$/\1/p' fuzz/Cargo.toml)

# Builds with overflow checks and debug assertions, without address sanitiser:
# the project has no unsafe code, and without tracing comparisons, which takes half
# the time: the targets make valid frames themselves. The programs are copied, so that a change of
# the sources during a run changes nothing.
build() {
    local host build="${CARGO_TARGET_DIR:-$PWD/fuzz/target}"
    host=$(rustc +nightly -vV | sed -n 's/^host: //p')
    cargo +nightly fuzz build --sanitizer none --no-trace-compares --debug-assertions --target-dir "$build"
    mkdir -p "$grown/bin"
    for target in $targets; do
        cp -f "$build/$host/release/$target" "$grown/bin/$target.new"
        mv -f "$grown/bin/$target.new" "$grown/bin/$target"
    done
    GROWN=$grown fuzz/places.py build
}

# One piece. What it found is counted in three ways. `cov` counts edges of the
# program, `ft` also how often they were taken; the ledger has the seconds since the last of
# either. `places` counts regions of the source: of a generic function an edge is there
# once for each rung and effect it is built for, a place once.
piece() {
    local target=$1 number event cov ft rest executions=0 result=ok places_new=0 places=0 new_to_all=0
    local cov_now=0 ft_now=0 cov_new=0 ft_new=0
    local start=$EPOCHSECONDS cov_s=$EPOCHSECONDS ft_s=$EPOCHSECONDS
    local options=(-max_total_time="$piece_s" -print_final_stats=1 -timeout=10 -artifact_prefix="$grown/crash-$target-")
    if [ -f "fuzz/dictionaries/$target.dict" ]; then options+=(-dict="fuzz/dictionaries/$target.dict"); fi
    mkdir -p "$grown/$target"
    while read -r number event rest; do
        case "$number $event" in
            \#[0-9]*" "[A-Z]*)
                read -r _ cov _ ft _ <<<"$rest"
                if [ "$event" = INITED ]; then
                    start=$EPOCHSECONDS cov_s=$start ft_s=$start
                elif [ "$cov_now" -gt 0 ]; then
                    if [ "$cov" -gt "$cov_now" ]; then cov_new=$((cov_new + cov - cov_now)) cov_s=$EPOCHSECONDS; fi
                    if [ "$ft" -gt "$ft_now" ]; then ft_new=$((ft_new + ft - ft_now)) ft_s=$EPOCHSECONDS; fi
                fi
                if [ "$event" != READ ]; then cov_now=$cov ft_now=$ft; fi
                ;;
            "stat::number_of_executed_units: "*) executions=$event ;;
            *ERROR*) result=crash ;;
        esac
    done < <("$grown/bin/$target" "${options[@]}" "$grown/$target" "fuzz/corpus/$target" 2>&1 | tee "$grown/last-$target.log")
    local now=$EPOCHSECONDS
    read -r places_new places _ new_to_all < <(places "$target")
    # In one write: two runs may share a ledger.
    printf '%s\t%s\t%d\t%d\t%d\t%d\t%d\t%d\t%d\t%d\t%s\t%d\t%d\t%d\n' "$target" "$(date -u +%FT%TZ)" $((now - start)) \
        "$executions" "$cov_now" "$ft_now" "$cov_new" "$ft_new" $((now - cov_s)) $((now - ft_s)) "$result" \
        "$places" "$places_new" "$new_to_all" |
        tee -a "$ledger"
}

# What the corpus reaches of the source, with files that were not read yet.
places() {
    GROWN=$grown fuzz/places.py new "$1" "$grown/$1" "fuzz/corpus/$1" 2>>"$grown/places-$1.log"
}

# Sums of the ledger. "Quiet": seconds of fuzzing since there was anything new.
status() {
    awk -F '\t' '
        FNR == 1 { next }
        !($1 in executions) { order[++count] = $1 }
        {
            executions[$1] += $4; seconds[$1] += $3; cov[$1] = $5; ft[$1] = $6
            no_cov[$1] = $7 > 0 ? $9 : no_cov[$1] + $3
            no_ft[$1] = $8 > 0 ? $10 : no_ft[$1] + $3
            # A piece that found a place counts for nothing, as one that was not looked at.
            places[$1] = $12; no_place[$1] = $13 > 0 || NF < 13 ? 0 : no_place[$1] + $3
            if ($11 == "crash") { crashes[$1]++; no_cov[$1] = no_ft[$1] = no_place[$1] = 0 }
            all += $4; all_s += $3
            # Of all targets together: since a piece found what no target had reached, or a crash.
            quiet_s += $3; quiet_runs += $4; quiet_of[$1] += $3
            if (NF < 14 || $14 > 0 || $11 == "crash") { quiet_s = quiet_runs = 0; delete quiet_of }
        }
        END {
            print "target        executions   minutes     cov      ft  places   quiet: cov, min   ft, min   places, min   crashes"
            for (i = 1; i <= count; i++) {
                t = order[i]
                printf "%-10s %13d %9.1f %7d %7d %7d %17.1f %9.1f %13.1f %9d\n", t, executions[t], seconds[t] / 60, \
                    cov[t], ft[t], places[t], no_cov[t] / 60, no_ft[t] / 60, no_place[t] / 60, crashes[t]
            }
            printf "%-10s %13d %9.1f\n", "all", all, all_s / 60
            printf "no place new to all targets, no crash: the last %.1f min, %d executions;", quiet_s / 60, quiet_runs
            for (i = 1; i <= count; i++) printf " %s %.1f", order[i], quiet_of[order[i]] / 60
            print ""
        }' "$ledger"
}

# Few files that take every edge that the grown corpus takes. What was made by
# hand or once broke a law stays; others are named for what they are. libFuzzer
# would keep the smallest file for each edge, which are many: of its list of
# edges by file, this takes the file with the most, then what adds to it.
merge() {
    local target=$1 out control file first count=0
    out=$(mktemp -d)
    control=$grown/merge-$target.control
    for file in "fuzz/corpus/$target"/{seed,crash}-*; do
        if [ -f "$file" ]; then cp "$file" "$out"; fi
    done
    mkdir -p "$grown/$target"
    rm -f "$control"
    "$grown/bin/$target" -set_cover_merge=1 -use_counters=0 -merge_control_file="$control" \
        -artifact_prefix="$grown/crash-$target-" \
        "$out" "$grown/$target" "fuzz/corpus/$target" >"$grown/merge-$target.log" 2>&1
    # The control file: number of files, of those in the first folder, their
    # names, then a line of edges for each.
    first=$(sed -n 2p "$control")
    mkdir "$out/found"
    while read -r file; do
        if [ "$count" -ge "$most_files" ]; then break; fi
        cp "$(sed -n "$((file + 3))p" "$control")" "$out/found/file"
        mv "$out/found/file" "$out/found/$(sha1sum "$out/found/file" | cut -c1-12)"
        count=$((count + 1))
    done < <(awk -v first="$first" '$1 == "FT" { print ($2 < first ? 1e9 : NF - 2), $2, $0 }' "$control" | sort -k1,1nr -k2,2n |
        awk -v first="$first" '{
            adds = 0
            for (i = 5; i <= NF; i++) if (!($i in seen)) { seen[$i]; adds = 1 }
            if (adds && $2 >= first) print $2
        }')
    rm -f "fuzz/corpus/$target"/found-*
    for file in "$out/found"/*; do
        if [ -f "$file" ]; then mv "$file" "fuzz/corpus/$target/found-$(basename "$file")"; fi
    done
    rm -r "$out"
    echo "$target: $(find "fuzz/corpus/$target" -type f | wc -l) files, $(cat "fuzz/corpus/$target"/* | wc -c) bytes"
}

case "${1:-}" in
    status) status ;;
    merge)
        shift
        build
        for target in ${*:-$targets}; do merge "$target"; done
        ;;
    *)
        build
        if [ ! -f "$ledger" ]; then
            printf 'target\tdate\tseconds\texecutions\tcov\tft\tnew cov\tnew ft\tquiet cov s\tquiet ft s\tresult\tplaces\tnew places\tnew to all\n' >"$ledger"
        fi
        for target in ${*:-$targets}; do
            mkdir -p "$grown/$target"
            echo "$target: $(places "$target") places are new, reached, known, new to all targets"
        done
        for ((round = 0; round < rounds; round++)); do
            for target in ${*:-$targets}; do piece "$target"; done
        done
        ;;
esac
