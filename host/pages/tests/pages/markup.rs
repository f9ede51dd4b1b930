//! Checks of markup.
#![allow(unreachable_pub, dead_code)]

use std::path::Path;

/// Leaves a file in the target's `tmp` directory to be looked at.
pub fn keep(name: &str, content: &str) {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(path, content).expect("written");
}

/// Keeps a page and asserts what every page must keep to: it is no longer than that, depends on
/// nothing outside, has nothing of what is wrong, and fits a phone.
pub fn assert_page(name: &str, page: &str, longest: usize, wrong: &[&str]) {
    keep(&format!("{name}.html"), page);
    assert!(page.len() < longest, "{name}: {} bytes", page.len());
    for part in ["http", "url(", "<script", "@import"].iter().chain(wrong) {
        assert!(!page.contains(part), "{name} contains {part}");
    }
    assert_balanced(page);
    assert_fits_a_phone(page);
    for chart in charts(page) {
        assert!(assert_labels_inside(&chart) > 3);
    }
}

/// Every element that opens closes, in order.
pub fn assert_balanced(page: &str) {
    let mut open = Vec::new();
    for part in page.split('<').skip(1) {
        let tag = part.split('>').next().unwrap_or_default();
        let name = tag.split([' ', '\n']).next().unwrap_or_default();
        if let Some(closed) = name.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed), "closing in {part:.60}");
        } else if !(tag.ends_with('/') || name.starts_with('!') || name == "meta") {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

/// Number of times that a page holds this part.
pub fn count(page: &str, part: &str) -> usize {
    page.matches(part).count()
}

/// A picture looks as it should in a program that knows no more than SVG: dark
/// ink on white paper, all of it inside.
pub fn assert_drawn(svg: &str) {
    assert_balanced(svg);
    assert_labels_inside(svg);
    assert!(!svg.contains("var("), "a variable is left");
    let mut options = resvg::usvg::Options::default();
    options.fontdb_mut().load_system_fonts();
    // The widest of those in use; without it the letters are left out.
    options.fontdb_mut().set_sans_serif_family("DejaVu Sans");
    let tree = resvg::usvg::Tree::from_str(svg, &options).expect("an SVG document");
    let size = tree.size().to_int_size();
    let (width, height) = (size.width(), size.height());
    let mut pixels = resvg::tiny_skia::Pixmap::new(width, height).expect("a size");
    let scale = resvg::tiny_skia::Transform::identity();
    resvg::render(&tree, scale, &mut pixels.as_mut());
    let (mut paper, mut luminance) = (0_u32, 0.0);
    for (i, pixel) in (0_u32..).zip(pixels.pixels()) {
        assert_eq!(pixel.alpha(), 255, "nothing is drawn there");
        let [r, g, b] = [pixel.red(), pixel.green(), pixel.blue()].map(f64::from);
        luminance += (0.2126 * r + 0.7152 * g + 0.0722 * b) / 255.0;
        let is_paper = [r, g, b] == [255.0; 3];
        paper += u32::from(is_paper);
        let (x, y) = (i % width, i / width);
        let at_border = x == 0 || y == 0 || x + 1 == width || y + 1 == height;
        assert!(
            is_paper || !at_border,
            "ink at the border: {x}, {y} of {width}, {height}"
        );
    }
    let all = f64::from(width * height);
    let (paper, mean) = (f64::from(paper) / all, luminance / all);
    assert!((0.05..0.999).contains(&paper), "{paper} of it is paper");
    assert!((0.55..0.9999).contains(&mean), "mean luminance {mean}");
}

/// No text leaves the view box, in any sans-serif font in use. Counts them.
pub fn assert_labels_inside(svg: &str) -> usize {
    let number = |tag: &str, key: &str| -> Option<f64> {
        let (_, rest) = tag.split_once(&format!(" {key}=\""))?;
        rest.split(['"', 'p']).next()?.parse().ok()
    };
    let view = svg.split_once("viewBox=\"0 0 ").expect("a view box").1;
    let mut size = view.split(['"', ' ']).map_while(|n| n.parse::<f64>().ok());
    let (width, height) = (
        size.next().expect("a width"),
        size.next().expect("a height"),
    );
    let mut shifts = vec![(0.0, 0.0)];
    let mut texts = 0;
    for element in svg.split('<').skip(1) {
        let (tag, words) = element.split_once('>').expect("an element");
        let shift = *shifts.last().expect("balanced");
        if tag == "/g" {
            shifts.pop();
        } else if tag == "g" || tag.starts_with("g ") {
            let mut by = tag
                .split(['(', ')', ' '])
                .filter_map(|n| n.parse::<f64>().ok());
            let by = by.next().zip(by.next()).unwrap_or_default();
            shifts.push((shift.0 + by.0, shift.1 + by.1));
        }
        let Some((x, y)) = number(tag, "x")
            .zip(number(tag, "y"))
            .filter(|_| tag.starts_with("text "))
        else {
            continue;
        };
        texts += 1;
        let size = number(tag, "font-size").unwrap_or(crepitus_pages::plot::text::SIZE);
        let words = words
            .replace("&amp;", "&")
            .replace("&lt;", "<")
            .replace("&gt;", ">")
            .replace("&quot;", "\"");
        let long = crepitus_pages::plot::text::width(words.trim(), size);
        let before = match () {
            () if tag.contains("text-anchor=\"middle\"") => 0.5 * long,
            () if tag.contains("text-anchor=\"end\"") => long,
            () => 0.0,
        };
        let (x, y) = (x + shift.0, y + shift.1);
        let (left, top, right, bottom) = if tag.contains("rotate(-90") {
            (x - size, y - long + before, x + 0.3 * size, y + before)
        } else {
            (x - before, y - size, x - before + long, y + 0.3 * size)
        };
        assert!(
            left >= 0.0 && top >= -0.5 && right <= width && bottom <= height,
            "{words:?} leaves the picture: {left:.0}..{right:.0} of {width}, {top:.0}..{bottom:.0} of {height}"
        );
    }
    texts
}

/// Asserts that on a narrow screen nothing is wider than the page: every chart, and every
/// table that cannot wrap, scrolls in a box of its own and does not shrink
/// beyond what can be read.
pub fn assert_fits_a_phone(page: &str) {
    assert!(page.contains("name=\"viewport\" content=\"width=device-width"));
    let rule = |selector: &str| {
        let (_, rest) = page
            .split_once(&format!("\n{selector} {{"))
            .expect("a rule");
        rest.split('}').next().expect("its end").to_owned()
    };
    let scrolling = rule(".box");
    assert!(scrolling.contains("overflow-x: auto") && scrolling.contains("max-width: 100%"));
    // Text of 15 px stays above 9.5 px.
    assert!(rule(".box > svg").contains("min-width: calc(var(--nominal) * 0.66)"));
    assert!(rule("figure").contains("min-width: 0"));
    let mut open: Vec<&str> = Vec::new();
    for tag in page
        .split('<')
        .skip(1)
        .map(|part| part.split('>').next().unwrap_or_default())
    {
        let name = tag.split([' ', '\n']).next().unwrap_or_default();
        let boxed = || open.iter().any(|tag| tag.starts_with("div class=\"box\""));
        if name == "svg" && tag.contains("role=\"img\"") {
            assert!(boxed(), "a chart outside a box: {tag:.80}");
            assert!(
                tag.contains("--nominal:"),
                "a chart without a width: {tag:.80}"
            );
        }
        if name == "table" && tag.contains("class=") {
            assert!(boxed(), "a wide table outside a box: {tag}");
        }
        if name.starts_with('/') {
            open.pop();
        } else if !(tag.ends_with('/') || name.starts_with('!') || name == "meta") {
            open.push(tag);
        }
    }
}

/// The charts of a page, one after the other.
pub fn charts(page: &str) -> impl Iterator<Item = String> {
    let parts: Vec<String> = page
        .split("<svg role=\"img\"")
        .skip(1)
        .filter_map(|part| {
            Some(format!(
                "<svg role=\"img\"{}</svg>",
                part.split_once("</svg>")?.0
            ))
        })
        .collect();
    parts.into_iter()
}

/// A picture can be printed at its width: labels inside, letters of at least 7 pt, lines of at least
/// half a point.
pub fn assert_printable(picture: &crepitus_pages::plot::Picture) {
    use crepitus_pages::plot::paper::{SMALLEST_PT, THINNEST_PT};
    let name = &picture.name;
    let mm = picture.print_mm();
    let svg = picture.clone().in_print().svg;
    assert!(svg.contains(&format!("width=\"{mm}mm\"")), "{name}");
    assert_labels_inside(&svg);
    let numbers = |key: &str| -> Vec<f64> {
        let key = format!(" {key}=\"");
        let parts = svg.split(&key).skip(1);
        parts
            .filter_map(|rest| rest.split_once('"')?.0.parse().ok())
            .collect()
    };
    let view = svg.split_once("viewBox=\"0 0 ").expect("a view box").1;
    let across: f64 = view
        .split(' ')
        .next()
        .expect("a width")
        .parse()
        .expect("a number");
    let pt_per_px = mm * 72.0 / 25.4 / across;
    for (key, least_pt) in [("font-size", SMALLEST_PT), ("stroke-width", THINNEST_PT)] {
        for px in numbers(key) {
            let pt = px * pt_per_px;
            assert!(pt > least_pt - 1e-9, "{name}: {key} of {pt} pt");
        }
    }
}

/// The page without the charts that a phone shows in place of wide ones.
pub fn on_a_desk(page: &str) -> String {
    let mut parts = page.split("<div class=\"charts narrow\">");
    let mut desk = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (_, rest) = part.split_once("<p class=\"caption\">").expect("a caption");
        desk += "<p class=\"caption\">";
        desk += rest;
    }
    desk
}
