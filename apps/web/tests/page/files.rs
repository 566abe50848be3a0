//! Files that a page serves, and texts that a build rewrites.

use std::path::Path;
use tresses_web::{book, serve, three};

#[test]
fn links_out_of_the_book_have_addresses() {
    let text = "[a](../../README.md#try-it) ![b](../pictures/c.png) [d](e.md) [f](https://g.h/i.md) [j](#k)";
    let linked = book::with_addresses(text, Path::new("docs/guide"));
    assert_eq!(linked, text.replace("../../README.md", &format!("{}README.md", book::FILES)));
}

#[test]
fn files_outside_the_folder_are_not_served() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    assert_eq!(serve::file(&folder, "/serve.rs?x=1"), Some(folder.join("serve.rs")));
    assert_eq!(serve::file(&folder, "/s%65rve.rs"), Some(folder.join("serve.rs")));
    for url in ["/../Cargo.toml", "/%2e%2e/Cargo.toml", "/..", "//etc/passwd", "/", "/none"] {
        assert_eq!(serve::file(&folder, url), None, "{url}");
    }
}

#[test]
fn imports_become_relative() {
    let text = "import {\n\tBox3\n} from 'three';\nimport { a } from '../utils/BufferGeometryUtils.js';\n\
        const text = \"x from 'three';\";\n * @three_import import { A } from 'three/addons/A.js';\n";
    let expected = "import {\n\tBox3\n} from './three.module.min.js';\nimport { a } from './BufferGeometryUtils.js';\n\
        const text = \"x from 'three';\";\n * @three_import import { A } from 'three/addons/A.js';\n";
    assert_eq!(three::relative(text).unwrap(), expected);
    let error = three::relative("import { b } from '../utils/Other.js';").unwrap_err().to_string();
    assert!(error.contains("../utils/Other.js"), "{error}");
}
