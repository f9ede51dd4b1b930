use super::*;
use crate::table::show::{fixed, microseconds, milli, scaled, scientific, signed};

struct Run {
    name: &'static str,
    with: Vec<&'static str>,
    torque_nm: f64,
    events: Option<u64>,
    failure: Option<&'static str>,
}

fn runs() -> [Run; 3] {
    let run = |name, torque_nm, events, failure| Run {
        name,
        with: vec!["cuff", "limb"],
        torque_nm,
        events,
        failure,
    };
    [
        run("all, \"whole\"", 0.1 + 0.2, Some(12), None),
        run("alone", f64::NAN, Some(3), None),
        run("none", f64::NEG_INFINITY, None, Some("it <diverged>")),
    ]
}

fn table(runs: &[Run]) -> Table<'_, Run> {
    Table::of(runs)
        .column("run", |run| run.name)
        .headed("run")
        .remark(|run| run.failure.map(str::to_owned))
        .group("what the hand feels")
        .column("torque_nm", |run| run.torque_nm)
        .headed("mN·m")
        .rounded(scaled::<1000, 1>)
        .column("events", |run| run.events)
        .headed("events")
        .rounded(signed)
        .group("")
        .column("with", |run| run.with.as_slice())
        .column("failed", |run| run.failure.is_some())
        .people("costs", |_| Cell::from(f64::NAN).shown_as("<3"))
}

#[test]
fn csv_has_all_digits_and_quotes() {
    assert_eq!(
        table(&runs()).to_csv(),
        "run,torque_nm,events,with,failed\n\
         \"all, \"\"whole\"\"\",0.30000000000000004,12,cuff limb,false\n\
         alone,nan,3,cuff limb,false\n\
         none,-inf,,cuff limb,true\n"
    );
    // Each of them is a reason for quotes.
    let words = ["\"euler\" diverged", "1, 2", "two\nlines", "one\rtwo"];
    let quoted = Table::of(&words).column("words", |words| *words);
    assert_eq!(
        quoted.to_csv(),
        "words\n\
         \"\"\"euler\"\" diverged\"\n\
         \"1, 2\"\n\
         \"two\nlines\"\n\
         \"one\rtwo\"\n"
    );
}

#[test]
fn json_has_the_names_and_numbers_of_csv() {
    let objects = serde_json::to_value(table(&runs())).unwrap();
    let objects = objects.as_array().unwrap();
    assert_eq!(objects[0]["torque_nm"].as_f64(), Some(0.1 + 0.2));
    assert!(objects[1]["torque_nm"].is_null() && objects[2]["events"].is_null());
    assert_eq!(objects[2]["failed"], true);
    assert_eq!(objects[0]["with"].as_array().unwrap().len(), 2);
    let csv = table(&runs()).to_csv();
    for object in objects {
        let names: Vec<_> = csv.lines().next().unwrap().split(',').collect();
        let object = object.as_object().unwrap();
        assert!(names.iter().all(|name| object.contains_key(*name)));
        assert_eq!(object.len(), names.len());
    }
}

#[test]
fn text_is_rounded_and_aligned() {
    assert_eq!(
        table(&runs()).to_text(),
        "              what the hand feels\n\
         run                  mN·m  events  costs\n\
         all, \"whole\"        300.0     +12     <3\n\
         alone                   –      +3     <3\n\
         none          it <diverged>\n"
    );
    let runs = runs();
    let unnamed = Table::of(&runs).people("", |run| run.name);
    assert_eq!(unnamed.to_text(), "all, \"whole\"\nalone\nnone\n");
}

#[test]
fn markdown_names_the_group_in_each_heading() {
    assert_eq!(
        table(&runs()).to_markdown(),
        "| run | what the hand feels: mN·m | what the hand feels: events | costs |\n\
         |---|---|---|---|\n\
         | all, \"whole\" | 300.0 | +12 | <3 |\n\
         | alone | – | +3 | <3 |\n\
         | none | it <diverged> |  |  |\n"
    );
    let bars = Table::of(&["a|b"]).people("x", |text| *text);
    assert_eq!(bars.to_markdown(), "| x |\n|---|\n| a\\|b |\n");
}

#[test]
fn numbers_of_a_page_are_as_on_paper() {
    let page = |text: &'static str| {
        let rows = [text];
        let table = Table::of(&rows)
            .people("", |_| "")
            .people("", |text| *text)
            .right();
        table.to_html().into_string()
    };
    for (text, shown) in [
        ("2.7e-7", "2.7·10⁻⁷"),
        ("-1.0e12", "−1.0·10¹²"),
        ("-3", "−3"),
        ("+12", "+12"),
        ("–", "–"),
        ("2 unmatched", "2 unmatched"),
        ("f32-like", "f32-like"),
        ("e-5", "e-5"),
        ("inf", "inf"),
    ] {
        let cell = format!("<td class=\"number\">{shown}</td>");
        assert!(page(text).contains(&cell), "{text}: {}", page(text));
    }
}

#[test]
fn html_is_escaped_and_says_what_are_numbers() {
    let page = table(&runs()).to_html().into_string();
    for part in [
        "<th class=\"group\" colspan=\"2\" scope=\"colgroup\">what the hand feels</th>",
        "<th class=\"number\" scope=\"col\">mN·m</th>",
        "<th scope=\"row\">alone</th><td class=\"number\">–</td>",
        "<td class=\"remark\" colspan=\"3\">it &lt;diverged&gt;</td>",
        "<td class=\"number\">&lt;3</td>",
    ] {
        assert!(page.contains(part), "{part} is not in {page}");
    }
}

#[test]
fn numbers_are_short() {
    assert_eq!(
        (fixed::<1>(2.25), fixed::<0>(f64::NAN)),
        ("2.2".into(), "–".into())
    );
    assert_eq!(
        (scientific(4.123e-5), scientific(0.0)),
        ("4.1e-5".into(), "0".into())
    );
    assert_eq!(microseconds(5e-5), "50 µs");
    assert_eq!(microseconds(1.0 / 30_000.0), "33.333333 µs");
    for (nm, text) in [
        (0.0, "0"),
        (1.234e-7, "1e-4"),
        (1.234e-3, "1.23"),
        (0.01234, "12.3"),
        (0.5, "500.0"),
        (3.0, "3000"),
        (f64::NAN, "–"),
    ] {
        assert_eq!(milli(nm), text);
    }
    assert_eq!(
        (signed(-3.0), signed(0.0), signed(2.0)),
        ("-3".into(), "0".into(), "+2".into())
    );
}
