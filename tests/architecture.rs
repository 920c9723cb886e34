//! The invariants of `ARCHITECTURE.md` that a compiler does not see: who may name whom, and what the core never does.

#[path = "architecture/file_graph.rs"]
mod file_graph;
#[path = "architecture/source.rs"]
mod source;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use file_graph::FileGraph;
use source::Source;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn source(path: &Path) -> Source {
    Source::read(&read(path)).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Every source file below a folder that is compiled into the library, in a fixed order.
fn library_files(folder: &Path) -> Vec<(PathBuf, Source)> {
    let (mut files, mut test_only, mut folders) = (Vec::new(), Vec::new(), vec![folder.to_path_buf()]);
    while let Some(folder) = folders.pop() {
        let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        for path in entries.map(|entry| entry.expect("a readable folder").path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let source = source(&path);
                let home = match path.file_stem().and_then(|stem| stem.to_str()) {
                    Some("mod" | "lib" | "main") | None => path.with_file_name(""),
                    Some(_) => path.with_extension(""),
                };
                for module in &source.test_modules {
                    test_only.push(home.join(format!("{module}.rs")));
                    test_only.push(home.join(module));
                }
                files.push((path, source));
            }
        }
    }
    files.retain(|(path, _)| !test_only.iter().any(|excluded| path.starts_with(excluded)));
    files.sort_by(|a, b| a.0.cmp(&b.0));
    files
}

/// Sources of the core, crate after crate: each may name those before it.
const CORE: [&str; 5] = ["mechanics/src", "excitation/src", "measurement/src", "estimation/src", "src"];

/// Sources of the other crates.
const ABOVE_THE_CORE: [&str; 8] =
    ["cdr/src", "io/src", "sim/src", "hardware/src", "reports/src", "workflow/src", "cli/src", "python/src"];

/// Every source file of the core that is compiled into it, with the folder of its crate.
fn core_files() -> Vec<(PathBuf, PathBuf, Source)> {
    let of_crate = |folder: &str| {
        let folder = root().join(folder);
        library_files(&folder).into_iter().map(move |(path, source)| (folder.clone(), path, source))
    };
    CORE.into_iter().flat_map(of_crate).collect()
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

/// The modules of the core in the order in which each `lib.rs` declares them, crate after crate.
fn module_order() -> Vec<String> {
    let declared = |folder: &str| source(&root().join(folder).join("lib.rs")).modules;
    CORE.into_iter().flat_map(declared).map(|module| module.text).collect()
}

/// The module of a crate that a file belongs to, and how many modules below the root it is.
fn module_of(folder: &Path, path: &Path) -> (String, usize) {
    let inner = path.strip_prefix(folder).expect("a file of the crate").with_extension("");
    let mut parts: Vec<String> = inner.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if parts.last().is_some_and(|part| part == "mod") {
        parts.pop();
    }
    (parts[0].clone(), parts.len())
}

fn assert_none(faults: &[String]) {
    assert!(faults.is_empty(), "{} violation(s):\n  {}", faults.len(), faults.join("\n  "));
}

#[test]
fn modules_of_the_core_stand_in_the_order_of_the_method() {
    let expected = "seed provenance plain number input observer remedy lanes linalg optimiser statistics spatial model chains trajectory dynamics regressor base codegen \
                    excitation experiment signal estimation diagnosis calibration study conformance";
    assert_eq!(module_order().join(" "), expected);
}

/// Macros that the core exports: Rust names them at the root of their crate, and the module that defines one hands it on.
fn exported_macros() -> BTreeSet<String> {
    let mut macros = BTreeSet::new();
    for (_, path, _) in core_files() {
        for definition in read(&path).split("#[macro_export]").skip(1) {
            let name = definition.split_once("macro_rules! ").and_then(|(_, rest)| rest.split_once(' '));
            macros.extend(name.map(|(name, _)| name.to_owned()));
        }
    }
    macros
}

#[test]
fn a_module_of_the_core_imports_only_from_those_above_it() {
    let order = module_order();
    let macros = exported_macros();
    let place = |name: &str| order.iter().position(|module| module == name);
    let mut faults = Vec::new();
    for (folder, path, source) in core_files() {
        let (module, depth) = module_of(&folder, &path);
        if module == "lib" {
            continue;
        }
        let Some(own) = place(&module) else {
            faults.push(format!("{}: module {module} is not declared in lib.rs", shown(&path)));
            continue;
        };
        for name in source.names_below("crate").into_iter().filter(|name| !macros.contains(&name.text)) {
            match place(&name.text) {
                Some(other) if other <= own => {}
                Some(_) => faults.push(format!(
                    "{}:{}: {module} names crate::{}, which stands below it",
                    shown(&path),
                    name.line,
                    name.text
                )),
                None => faults.push(format!(
                    "{}:{}: crate::{} is no module; name the module that holds it",
                    shown(&path),
                    name.line,
                    name.text
                )),
            }
        }
        for line in source.climbs_to_root(depth) {
            faults.push(format!("{}:{line}: reaches the root through super; write crate::", shown(&path)));
        }
    }
    assert_none(&faults);
}

#[test]
fn crates_depend_as_the_house_is_built() {
    // The manifest, and which of our own crates it may name.
    let allowed: [(&str, &[&str]); 15] = [
        ("mechanics/Cargo.toml", &[]),
        ("excitation/Cargo.toml", &["armid-mechanics"]),
        ("measurement/Cargo.toml", &["armid-mechanics", "armid-excitation"]),
        ("estimation/Cargo.toml", &["armid-mechanics", "armid-measurement"]),
        ("Cargo.toml", &["armid-mechanics", "armid-excitation", "armid-measurement", "armid-estimation"]),
        ("cdr/Cargo.toml", &[]),
        ("io/Cargo.toml", &["armid", "armid-cdr"]),
        ("sim/Cargo.toml", &["armid"]),
        ("hardware/Cargo.toml", &["armid", "armid-cdr"]),
        ("reports/Cargo.toml", &["armid"]),
        ("workflow/Cargo.toml", &["armid", "armid-io", "armid-sim", "armid-hardware", "armid-reports"]),
        (
            "cli/Cargo.toml",
            &["armid", "armid-cdr", "armid-io", "armid-sim", "armid-hardware", "armid-reports", "armid-workflow"],
        ),
        ("python/Cargo.toml", &["armid", "armid-io", "armid-sim", "armid-workflow"]),
        ("fuzz/Cargo.toml", &["armid", "armid-cdr", "armid-io", "armid-hardware", "armid-reports"]),
        ("examples/Cargo.toml", &["armid", "armid-io", "armid-sim", "armid-workflow"]),
    ];
    let members: toml::Table = read(&root().join("Cargo.toml")).parse().expect("a manifest");
    let members = members["workspace"]["members"].as_array().expect("a list").len();
    assert_eq!(members, allowed.len(), "a new crate belongs in this test");
    let mut faults = Vec::new();
    for (manifest, allowed) in allowed {
        let table: toml::Table = read(&root().join(manifest)).parse().expect("a manifest");
        for (kind, dependencies) in dependency_tables(&table) {
            for name in dependencies.keys().filter(|name| name.starts_with("armid")) {
                if !allowed.contains(&name.as_str()) {
                    faults.push(format!("{manifest}: [{kind}] names {name}, expected only {allowed:?}"));
                }
            }
        }
    }
    assert_none(&faults);
}

/// Every table of dependencies of a manifest, for all targets and for each one.
fn dependency_tables(manifest: &toml::Table) -> Vec<(String, &toml::Table)> {
    let kinds = ["dependencies", "dev-dependencies", "build-dependencies"];
    let mut tables = Vec::new();
    for kind in kinds {
        if let Some(table) = manifest.get(kind).and_then(toml::Value::as_table) {
            tables.push((kind.to_owned(), table));
        }
        let targets = manifest.get("target").and_then(toml::Value::as_table);
        for (target, table) in targets.into_iter().flatten() {
            if let Some(table) = table.get(kind).and_then(toml::Value::as_table) {
                tables.push((format!("target.{target}.{kind}"), table));
            }
        }
    }
    tables
}

#[test]
fn the_core_touches_neither_files_nor_clock_nor_terminal() {
    let mut faults = Vec::new();
    for (_, path, source) in core_files() {
        for name in source.names_below("std") {
            if ["fs", "env", "time", "net", "process", "io", "os", "path", "thread"].contains(&name.text.as_str()) {
                faults.push(format!("{}:{}: std::{}", shown(&path), name.line, name.text));
            }
        }
        for call in &source.macros {
            if ["println", "print", "eprintln", "eprint", "dbg"].contains(&call.text.as_str()) {
                faults.push(format!("{}:{}: {}!", shown(&path), call.line, call.text));
            }
        }
    }
    for folder in CORE {
        let attributes = source(&root().join(folder).join("lib.rs")).attributes;
        let forbids = attributes.iter().any(|attribute| attribute == "forbid(unsafe_code)");
        assert!(forbids, "{folder}/lib.rs: forbid(unsafe_code)");
    }
    assert_none(&faults);
}

#[test]
fn texts_below_the_command_name_neither_flags_nor_commands() {
    // What helps is a `Remedy`, which the command words as flags, and a library by its own names.
    let is_flag = |text: &str| text.split("--").skip(1).any(|rest| rest.starts_with(|c: char| c.is_ascii_lowercase()));
    let mut faults = Vec::new();
    for folder in CORE.into_iter().chain(ABOVE_THE_CORE).filter(|folder| *folder != "cli/src") {
        for (path, source) in library_files(&root().join(folder)) {
            for text in source.texts.iter().filter(|word| is_flag(&word.text) || word.text.contains("`armid")) {
                faults.push(format!("{}:{}: {}", shown(&path), text.line, text.text));
            }
        }
    }
    assert_none(&faults);
}

#[test]
fn transcendental_functions_come_from_one_place() {
    // The standard library hands these to the C library or the CPU, whose last bit differs between machines.
    let forbidden = [
        "sin", "cos", "tan", "sin_cos", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh", "acosh",
        "atanh", "exp", "exp2", "exp_m1", "ln", "log", "log2", "log10", "ln_1p", "powf", "cbrt", "hypot", "mul_add",
    ];
    let mut faults = Vec::new();
    for folder in CORE.into_iter().chain(["sim/src"]) {
        for (path, source) in library_files(&root().join(folder)) {
            for method in source.methods.iter().filter(|method| forbidden.contains(&method.text.as_str())) {
                faults.push(format!("{}:{}: .{}(), expected libm::…", shown(&path), method.line, method.text));
            }
            for named in &source.paths {
                if let [.., primitive, function] = named.segments.as_slice()
                    && primitive == "f64"
                    && forbidden.contains(&function.as_str())
                {
                    faults.push(format!("{}:{}: f64::{function}, expected libm::…", shown(&path), named.line));
                }
            }
        }
    }
    assert_none(&faults);
}

#[test]
fn no_module_is_a_drawer_for_everything() {
    let drawers = ["util", "utils", "common", "helper", "helpers", "misc", "types", "traits", "prelude"];
    let mut faults = Vec::new();
    for folder in CORE.into_iter().chain(ABOVE_THE_CORE) {
        for (path, source) in library_files(&root().join(folder)) {
            for name in drawers {
                if path.file_stem().is_some_and(|stem| stem == name) || path.iter().any(|part| part == name) {
                    faults.push(format!("{}: a module called {name}", shown(&path)));
                }
                for module in source.modules.iter().filter(|module| module.text == name) {
                    faults.push(format!("{}:{}: a module called {name}", shown(&path), module.line));
                }
            }
        }
    }
    assert_none(&faults);
}

#[test]
fn a_mod_file_holds_no_logic() {
    let mut faults = Vec::new();
    for folder in CORE.into_iter().chain(ABOVE_THE_CORE) {
        for (path, source) in library_files(&root().join(folder)) {
            if path.file_name().is_none_or(|name| name != "mod.rs") {
                continue;
            }
            for line in source.logic {
                faults.push(format!("{}:{line}: an item; expected documentation, mod and use", shown(&path)));
            }
        }
    }
    assert_none(&faults);
}

/// Files of a module, or of a crate above the core, that may name each other, and why; a circle lies within one of these lists.
const CIRCLES: &[(&str, &[&str], &str)] = &[
    (
        "model",
        &["drive", "joint", "robot", "robot_error", "term/entry", "term/handle", "term/law", "term/list"],
        "the registry of torque terms: each has a law, whose input is the robot, whose drives name terms",
    ),
    (
        "study",
        &[
            "comparison",
            "criterion_correlation",
            "design",
            "estimator_comparison",
            "evidence",
            "family_score",
            "replication",
            "setup",
            "truth_comparison",
        ],
        "the registry of a study's evidence: it lists every comparison, and each reads the metrics and runs it is of",
    ),
    ("io/src", &["error", "text"], "an error points into a text, and reading a text may end in an error"),
    (
        "sim/src",
        &["analytic/plant", "analytic/team"],
        "a plant makes the team in which plants like it advance together",
    ),
    (
        "sim/src",
        &["analytic/chain", "analytic/forces", "analytic/forward"],
        "a chain has forces at its joints; how fast they fall follows from the factor of its mass matrix",
    ),
    (
        "hardware/src",
        &["link/follow", "link/ros2_arm"],
        "what an arm does while it follows a plan is a file of its own",
    ),
    (
        "cli/src",
        &["commands/command", "commands/command_line", "commands/completions"],
        "the completions of the whole command line are one of its commands",
    ),
];

/// The files of each module of the core, by their paths inside it.
fn modules(files: &[(PathBuf, PathBuf, Source)]) -> BTreeMap<String, Vec<(String, &Source)>> {
    let mut modules: BTreeMap<String, Vec<(String, &Source)>> = BTreeMap::new();
    for (folder, path, source) in files {
        let inner = path.strip_prefix(folder).expect("a file of the crate").with_extension("");
        let parts: Vec<&str> = inner.iter().filter_map(|part| part.to_str()).collect();
        if let [module, rest @ ..] = parts.as_slice()
            && !rest.is_empty()
        {
            modules.entry((*module).to_owned()).or_default().push((rest.join("/"), source));
        }
    }
    modules
}

#[test]
fn files_of_a_module_form_no_circle_but_registries() {
    let files = core_files();
    let faults =
        modules(&files).into_iter().flat_map(|(module, sources)| circles(&module, &FileGraph::new(&module, sources)));
    assert_none(&faults.collect::<Vec<_>>());
}

#[test]
fn a_file_names_the_file_that_holds_what_it_uses() {
    let files = core_files();
    let mut faults = Vec::new();
    for (module, sources) in modules(&files) {
        for (file, line, holder) in FileGraph::new(&module, sources).taken_from_above() {
            faults.push(format!("{module}/{file}.rs:{line}: a name of mod.rs, expected it from {holder}"));
        }
    }
    assert_none(&faults);
}

/// The circles of a graph that [`CIRCLES`] does not list under `name`.
fn circles(name: &str, graph: &FileGraph<'_>) -> Vec<String> {
    let is_listed = |circle: &BTreeSet<String>| {
        CIRCLES.iter().any(|(of, files, _)| *of == name && circle.iter().all(|file| files.contains(&file.as_str())))
    };
    let circles = graph.circles().into_iter().filter(|circle| !is_listed(circle));
    circles
        .map(|circle| {
            let files: Vec<&str> = circle.iter().map(String::as_str).collect();
            format!("{name}: {} name each other in a circle", files.join(", "))
        })
        .collect()
}

#[test]
fn files_of_the_crates_above_the_core_form_no_circle() {
    let mut faults = Vec::new();
    for folder in ABOVE_THE_CORE {
        let root = root().join(folder);
        let files = library_files(&root);
        let sources = files.iter().map(|(path, source)| {
            let inner = path.strip_prefix(&root).expect("a file of the crate").with_extension("");
            let inner = inner.to_string_lossy().into_owned();
            (if matches!(inner.as_str(), "lib" | "main") { "mod".to_owned() } else { inner }, source)
        });
        faults.extend(circles(folder, &FileGraph::new("", sources)));
    }
    assert_none(&faults);
}

#[test]
fn an_estimator_states_its_equation_its_assumptions_when_it_fails_and_its_source() {
    let (mut estimators, mut faults) = (0, Vec::new());
    for (path, _) in library_files(&root().join("estimation/src/estimation")) {
        let text = read(&path);
        // What the list in kind.rs calls.
        if !text.contains("pub(crate) fn estimate(name: &str") {
            continue;
        }
        estimators += 1;
        let lines: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("//!")).collect();
        let description = lines.join("\n");
        for part in ["```text", "Assumes", "Fails", "Source"] {
            if !description.contains(part) {
                faults.push(format!("{}: the description of the module has no \"{part}\"", shown(&path)));
            }
        }
    }
    // Those of one equation, by several losses or priors, share a file.
    assert!(estimators >= 19, "found {estimators} files with an estimator");
    assert_none(&faults);
}

#[test]
fn the_reader_of_sources_sees_what_it_should() {
    let source = Source::read(
        r##"
        // use crate::comment;
        /* use crate::outer; /* nested */ use crate::still; */
        use crate::{seed, model::{Robot, Joint}, spatial as s};
        const TEXT: &str = "use crate::text; // \" }";
        const RAW: &str = r#"use crate::raw; " "#;
        const QUOTE: char = '"';
        fn f<'a>(x: &'a str) -> crate::linalg::Gram { std::fs::read(x) }
        #[cfg(test)]
        use crate::{study, estimation};
        #[cfg(test)]
        mod outside;
        #[cfg(test)]
        #[allow(dead_code)]
        mod tests { fn g() { crate::signal::h("}"); } }
        #[cfg(not(test))]
        fn kept() { super::super::above(); }
        mod inner { use super::near; }
        #[error("an {attribute}")]
        struct Said;
        fn waves(x: f64) { assert!(x.sin() < f64::cos(x), "{}", crate::base::of!(x)); x.tan(); }
        "##,
    )
    .expect("Rust");
    let names: Vec<String> = source.names_below("crate").into_iter().map(|word| word.text).collect();
    assert_eq!(names, ["seed", "model", "model", "spatial", "linalg", "base"]);
    let std: Vec<String> = source.names_below("std").into_iter().map(|word| word.text).collect();
    assert_eq!(std, ["fs"]);
    assert_eq!(source.test_modules, ["outside"]);
    // A file two modules below the root: super::super is the root, super inside an inline module is not.
    assert_eq!(source.climbs_to_root(2), [17]);
    assert_eq!(source.climbs_to_root(1), [17]);
    let methods: Vec<String> = source.methods.into_iter().map(|word| word.text).collect();
    assert_eq!(methods, ["sin", "tan"]);
    let macros: Vec<String> = source.macros.into_iter().map(|word| word.text).collect();
    assert_eq!(macros, ["assert", "of"]);
    assert!(source.paths.iter().any(|path| path.segments == ["f64", "cos"]));
    let texts: Vec<&str> = source.texts.iter().map(|word| word.text.as_str()).collect();
    assert_eq!(texts, ["use crate::text; // \" }", "use crate::raw; \" ", "\"an {attribute}\"", "\"{}\""]);
}

#[test]
fn a_circle_of_files_is_seen_through_re_exports() {
    let read = |text: &str| Source::read(text).expect("Rust");
    let (top, kinds, kind, one, apart) = (
        read("mod one; pub mod kinds; pub use kinds::Kind; pub use one::One;"),
        read("mod kind; pub use kind::Kind;"),
        read("use crate::room::One; pub enum Kind { One(One) }"),
        read("use super::Kind; pub struct One; #[cfg(test)] mod tests { use crate::room::apart::Apart; }"),
        read("use super::one::One; pub struct Apart(One);"),
    );
    let files = [("mod", &top), ("kinds/mod", &kinds), ("kinds/kind", &kind), ("one", &one), ("apart", &apart)];
    let graph = FileGraph::new("room", files.map(|(path, source)| (path.to_owned(), source)));
    assert_eq!(graph.circles(), [BTreeSet::from(["kinds/kind".to_owned(), "one".to_owned()])]);
}
