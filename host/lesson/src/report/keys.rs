//! Texts of the report, in both languages. `host/lesson/report-strings.json` is made of them, for
//! the panel's tables.

/// A text of the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key {
    /// Its key in the tables of texts.
    pub key: &'static str,
    /// English.
    pub en: &'static str,
    /// German.
    pub de: &'static str,
}

const fn key(key: &'static str, en: &'static str, de: &'static str) -> Key {
    Key { key, en, de }
}

/// All texts of the report; `{names}` in braces are replaced by values.
pub const KEYS: &[Key] = &[
    key("report.language", "en", "de"),
    key("report.decimal_point", ".", ","),
    key("report.kind", "Report of a lesson", "Bericht einer Übung"),
    key("report.date", "Date", "Datum"),
    key("report.lesson", "Lesson", "Übung"),
    key("report.blind", "blind", "verdeckt"),
    key("report.open", "open", "offen"),
    key("report.trials", "Knees examined", "Untersuchte Knie"),
    key(
        "report.trials_value",
        "{examined} of {trials}",
        "{examined} von {trials}",
    ),
    key(
        "report.seed",
        "Seed of the order",
        "Startwert der Reihenfolge",
    ),
    key("report.students", "Students", "Lernende"),
    key("report.recordings", "Recordings", "Aufzeichnungen"),
    key("report.version", "Crepitus version", "Crepitus-Version"),
    key(
        "report.not_ended",
        "This lesson has not ended.",
        "Diese Übung ist nicht beendet.",
    ),
    key("report.results", "Results", "Ergebnisse"),
    key("report.student", "Student", "Lernende Person"),
    key("report.all", "All together", "Alle zusammen"),
    key("report.right", "Right disorder", "Störung richtig"),
    key(
        "report.right_value",
        "{right} of {answers}",
        "{right} von {answers}",
    ),
    key(
        "report.kappa",
        "Kappa of the disorder (95\u{a0}%)",
        "Kappa der Störung (95\u{a0}%)",
    ),
    key(
        "report.level_kappa",
        "Weighted kappa of the level (95\u{a0}%)",
        "Gewichtetes Kappa des Grades (95\u{a0}%)",
    ),
    key(
        "report.interval",
        "{value} ({low} to {high})",
        "{value} ({low} bis {high})",
    ),
    key("report.undefined", "–", "–"),
    key(
        "report.confidence_right",
        "Confidence when right",
        "Sicherheit, wenn richtig",
    ),
    key(
        "report.confidence_wrong",
        "Confidence when wrong",
        "Sicherheit, wenn falsch",
    ),
    key("report.trial", "No.", "Nr."),
    key("report.knee", "Knee", "Knie"),
    key("report.answer", "Answer", "Antwort"),
    key("report.confidence", "Confidence", "Sicherheit"),
    key("report.verdict", "Right?", "Richtig?"),
    key("report.yes", "yes", "ja"),
    key("report.no", "no", "nein"),
    key("report.not_the_level", "not the level", "Grad nicht"),
    key("report.no_answer", "no answer", "keine Antwort"),
    key(
        "report.confusion",
        "Rows: the knee. Columns: the answer.",
        "Zeilen: das Knie. Spalten: die Antwort.",
    ),
    key("report.knees", "Knees", "Knie"),
    key("report.notes", "Notes", "Notizen"),
    key("report.time", "Time, s", "Zeit, s"),
    key("report.note", "Note", "Notiz"),
    key(
        "report.about_kappa",
        "Kappa is 1 if every answer is right and 0 if as many are right as by chance; – where it is not defined.",
        "Kappa ist 1, wenn jede Antwort richtig ist, und 0, wenn so viele richtig sind wie durch Zufall; – wo es nicht definiert ist.",
    ),
    key(
        "report.few",
        "With fewer than 20 answers its interval is only rough.",
        "Mit weniger als 20 Antworten ist sein Intervall nur grob.",
    ),
    key(
        "report.no_width",
        "An interval without width does not mean certainty.",
        "Ein Intervall ohne Breite bedeutet keine Gewissheit.",
    ),
    key(
        "report.pooled",
        "Several students examined the same knees, so the interval of all together is too narrow.",
        "Mehrere Personen haben dieselben Knie untersucht; das Intervall aller zusammen ist deshalb zu schmal.",
    ),
    key("report.disorder.healthy", "Healthy", "Gesund"),
    key("report.disorder.end-feel", "End-feel", "Endgefühl"),
    key(
        "report.disorder.range-deficit",
        "Range deficit",
        "Bewegungsdefizit",
    ),
    key(
        "report.disorder.rigidity",
        "Lead-pipe rigidity",
        "Bleirohr-Rigor",
    ),
    key(
        "report.disorder.cogwheel",
        "Cogwheel rigidity",
        "Zahnrad-Rigor",
    ),
    key("report.disorder.spasticity", "Spasticity", "Spastik"),
    key(
        "report.disorder.clasp-knife",
        "Clasp-knife",
        "Taschenmesser",
    ),
    key("report.disorder.clonus", "Clonus", "Klonus"),
    key("report.disorder.texture", "Roughness", "Rauigkeit"),
    key("report.disorder.crepitus", "Crepitus", "Krepitation"),
    key("report.level.mild", "mild", "leicht"),
    key("report.level.moderate", "moderate", "mittel"),
    key("report.level.severe", "severe", "schwer"),
];
