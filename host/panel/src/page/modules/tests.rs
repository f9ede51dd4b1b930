use super::*;

const FILES: [(&str, &str); 5] = [
    (
        "page/main.js",
        "import { b as c } from \"../b.js\";\n\
         import {\n  a,\n  d,\n} from \"../a.js\";\n\
         c(a, d);\n",
    ),
    (
        "a.js",
        "export const a = 1;\nexport class d {}\nlet important = a;\n",
    ),
    (
        "b.js",
        "import { a } from \"./a.js\";\n\
         /** Doubles. */\n\
         export async function b() {\n  return 2 * a;\n}\n",
    ),
    (
        "one.js",
        "import { two } from \"./two.js\";\nexport const one = 1;\n",
    ),
    (
        "two.js",
        "import { one } from \"./one.js\";\nexport const two = 2;\n",
    ),
];

fn find(path: &str) -> Option<&'static str> {
    let found = FILES.iter().find(|(name, _)| *name == path);
    found.map(|(_, text)| *text)
}

/// The error of a module with this text.
fn error_of(text: &'static str) -> PageError {
    script("page/x.js", &|path| match path {
        "page/x.js" => Some(text),
        other => find(other),
    })
    .unwrap_err()
}

#[test]
fn a_module_comes_behind_those_that_it_imports() {
    assert_eq!(
        script("page/main.js", &find).unwrap(),
        "\"use strict\";\n\
         const $0 = (() => {\n\
         const a = 1;\nclass d {}\nlet important = a;\n\
         return { a, d };\n\
         })();\n\
         const $1 = (() => {\n\
         const { a } = $0;\n\
         /** Doubles. */\nasync function b() {\n  return 2 * a;\n}\n\
         return { b };\n\
         })();\n\
         const $2 = (() => {\n\
         const { b: c } = $1;\n\
         const { a, d } = $0;\n\
         c(a, d);\n\
         return {  };\n\
         })();\n"
    );
}

#[test]
fn a_form_that_is_not_known_is_an_error() {
    for line in [
        "import a from \"../a.js\";",
        "import * as a from \"../a.js\";",
        "import \"../a.js\";",
        "import { a } from '../a.js';",
        "import { a } from \"a\";",
        "import { a as } from \"../a.js\";",
        "import { default as a } from \"../../a.js\";",
        "import { a",
        "const a = await import(\"../a.js\");",
        "const here = import.meta.url;",
        "export default 1;",
        "export { a };",
        "export{a};",
        "export * from \"../a.js\";",
        "export let a = 1;",
        "export const { a } = b;",
        "export function* a() {}",
        "  export const a = 1;",
    ] {
        let error = error_of(line);
        let is_form = matches!(&error, PageError::Form { file, .. } if file == "page/x.js");
        assert!(is_form, "{line}: {error}");
    }
}

#[test]
fn what_is_not_there_is_an_error() {
    assert_eq!(
        error_of("import { a } from \"./a.js\";"),
        PageError::Missing {
            file: "page/x.js".to_owned(),
            import: "page/a.js".to_owned(),
        }
    );
    assert_eq!(
        error_of("import { a, e } from \"../a.js\";"),
        PageError::NotExported {
            file: "page/x.js".to_owned(),
            import: "a.js".to_owned(),
            name: "e".to_owned(),
        }
    );
    assert_eq!(
        error_of("import { one } from \"../one.js\";"),
        PageError::Circle {
            file: "one.js".to_owned(),
        }
    );
}
