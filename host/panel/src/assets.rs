//! The files of the page.

/// A file: its path, its type, its content.
pub(crate) struct Asset {
    pub(crate) path: &'static str,
    pub(crate) kind: &'static str,
    pub(crate) body: &'static [u8],
}

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const JSON: &str = "application/json";

macro_rules! assets {
    ($($kind:ident $file:literal),* $(,)?) => {
        /// All of them.
        pub(crate) const ASSETS: &[Asset] = &[$(Asset {
            path: concat!("/", $file),
            kind: $kind,
            body: include_bytes!(concat!("../assets/", $file)),
        }),*];
    };
}

assets![
    HTML "index.html",
    HTML "remote.html",
    HTML "student.html",
    CSS "panel.css",
    SCRIPT "answer-form.js",
    SCRIPT "bins.js",
    SCRIPT "charts.js",
    SCRIPT "class.js",
    SCRIPT "connection.js",
    SCRIPT "control.js",
    SCRIPT "cutaway.js",
    SCRIPT "dialogs.js",
    SCRIPT "dom.js",
    SCRIPT "drawer.js",
    SCRIPT "examination.js",
    SCRIPT "experiment-run.js",
    SCRIPT "experiment-setup.js",
    SCRIPT "experiment.js",
    SCRIPT "feel.js",
    SCRIPT "flow.js",
    SCRIPT "guide.js",
    SCRIPT "hand.js",
    SCRIPT "inside.js",
    SCRIPT "joint.js",
    SCRIPT "knee.js",
    SCRIPT "labels.js",
    SCRIPT "lateness.js",
    SCRIPT "leg.js",
    SCRIPT "lesson-results.js",
    SCRIPT "lesson-run.js",
    SCRIPT "lesson-setup.js",
    SCRIPT "lesson.js",
    SCRIPT "live-inside.js",
    SCRIPT "live.js",
    SCRIPT "loop.js",
    SCRIPT "main.js",
    SCRIPT "measures.js",
    SCRIPT "names.js",
    SCRIPT "next.js",
    SCRIPT "notes.js",
    SCRIPT "pain.js",
    SCRIPT "paint.js",
    SCRIPT "phone.js",
    SCRIPT "player.js",
    SCRIPT "recordings.js",
    SCRIPT "remote.js",
    SCRIPT "report.js",
    SCRIPT "save-knee.js",
    SCRIPT "slow.js",
    SCRIPT "sound-law.js",
    SCRIPT "sound-worklet.js",
    SCRIPT "sound.js",
    SCRIPT "states.js",
    SCRIPT "stop.js",
    SCRIPT "storage.js",
    SCRIPT "strings.js",
    SCRIPT "student.js",
    SCRIPT "tabs.js",
    SCRIPT "target.js",
    SCRIPT "wall.js",
    CSS "vendor/uPlot.min.css",
    SCRIPT "vendor/uPlot.esm.js",
    JSON "strings/de.json",
    JSON "strings/en.json",
];

/// The file at a path.
pub(crate) fn find(path: &str) -> Option<&'static Asset> {
    let path = if path == "/" { "/index.html" } else { path };
    ASSETS.iter().find(|asset| asset.path == path)
}

/// Returns whether a path is that of a page, to which a link can lead.
pub(crate) fn is_page(path: &str) -> bool {
    find(path).is_some_and(|asset| asset.kind == HTML)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::{Path, PathBuf};

    fn files(folder: &Path, found: &mut BTreeSet<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                files(&path, found);
            } else {
                found.insert(path);
            }
        }
    }

    /// The files that a page has loaded once it has started: modules that it imports later are not among them.
    fn loaded(page: &str) -> BTreeSet<&'static str> {
        let mut found = BTreeSet::new();
        let mut left = vec![find(page).unwrap()];
        while let Some(asset) = left.pop() {
            let text = std::str::from_utf8(asset.body).unwrap();
            if !found.insert(asset.path) {
                continue;
            }
            for before in ["from \"", "src=\"", "href=\""] {
                let rests = text.split(before).skip(1);
                let names = rests.filter_map(|rest| rest.split('"').next());
                let paths = names.map(|name| format!("/{}", name.trim_start_matches("./")));
                left.extend(paths.filter_map(|path| find(&path)));
            }
        }
        found
    }

    #[test]
    fn every_page_is_light() {
        // A page has one of the languages.
        let texts = find("/strings/en.json").unwrap().body.len();
        for page in ["/", "/student.html", "/remote.html"] {
            let loaded = loaded(page);
            assert!(loaded.contains("/connection.js") && !loaded.contains("/player.js"));
            let bytes: usize = (loaded.iter())
                .map(|path| find(path).unwrap().body.len())
                .sum();
            assert!(bytes + texts <= 300_000, "{page}: {bytes} + {texts}");
        }
        assert!(loaded("/").contains("/vendor/uPlot.esm.js"));
    }

    #[test]
    fn every_file_is_served() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
        let mut found = BTreeSet::new();
        files(&folder, &mut found);
        // The licence stands in the file that it is of, too; the page of one file has a list of its own.
        let page = folder.join("page");
        found.retain(|path| {
            let is_of_page = path.starts_with(&page) || path.ends_with("knee.wasm");
            !is_of_page && path.extension().is_none_or(|e| e != "LICENSE")
        });
        let served: BTreeSet<_> = (ASSETS.iter())
            .map(|asset| folder.join(asset.path.trim_start_matches('/')))
            .collect();
        assert_eq!(found, served);
    }
}
