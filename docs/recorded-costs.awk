# The page of costs on recorded knees: from the points.csv of one recording under one convention each.
BEGIN {
    print "# Costs on recorded knees"
    print ""
    print "Made by `docs/figures.sh`, where the recordings are: a squat and two walks, which are not in the project. `crepitus accuracy"
    print "--quick --scene` studies each on the paper's joint. A cell has, in f32 at the step of 50 µs, the root mean square error of the event"
    print "times, that of the torque at the tick, and the time of a step with half the distance of its quartiles: CPU time of the computer"
    print "that made the page. Where a rung finds other events than the reference, so many are without a partner."
}
FNR == 1 { for (n = 1; n <= NF; n++) at[$n] = n; next }
$at["precision"] == "f32" && $at["step_s"] + 0 == 5e-5 {
    convention = $at["convention"]; solver = $at["solver"]; scene = $at["scene"]
    if (!(scene in seen)) { seen[scene] = 1; scenes[++scene_count] = scene }
    if (!(solver in met)) { met[solver] = 1; solvers[++solver_count] = solver }
    events = $at["unmatched"] > 0 ? $at["unmatched"] " of " $at["events_true"] " unmatched" : sprintf("%.0e s", $at["rms_event_error_s"])
    half = ($at["ns_per_step_q3"] - $at["ns_per_step_q1"]) / 2
    cell_text = sprintf("%s, %.0e N·m, %.2f ± %.2f ns", events, $at["rms_tick_torque_error_nm"], $at["ns_per_step"], half)
    gsub(/e-0/, "e-", cell_text)
    cell[convention, solver, scene] = cell_text
}
END {
    split("frozen physical", conventions, " ")
    for (c = 1; c <= 2; c++) {
        printf "\n| `%s` |", conventions[c]
        for (n = 1; n <= scene_count; n++) printf " %s |", scenes[n]
        printf "\n|---|"
        for (n = 1; n <= scene_count; n++) printf "---|"
        printf "\n"
        for (r = 1; r <= solver_count; r++) {
            if (!((conventions[c], solvers[r], scenes[1]) in cell)) continue
            printf "| `%s` |", solvers[r]
            for (n = 1; n <= scene_count; n++) printf " %s |", cell[conventions[c], solvers[r], scenes[n]]
            printf "\n"
        }
    }
}
