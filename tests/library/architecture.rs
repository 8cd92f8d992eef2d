//! Checks the order of modules that `src/lib.rs` and every `mod.rs` declare: a module uses only modules declared above
//! it.
//!
//! A module may also use what its ancestors define. Unit tests inside modules are exempt. Paths count as they are
//! written (`crate::`, `super::`). A name that a `mod.rs` re-exports counts as the module that it comes from.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// A module's path from the crate's root, such as `["impact", "analysis"]`.
type ModulePath = Vec<String>;

/// The parsed source of one module.
#[derive(Default)]
struct Module {
    /// Child modules in the order of their declarations.
    children: Vec<String>,
    /// Imported and re-exported names, and the path of each.
    imports: BTreeMap<String, ModulePath>,
    /// Every path in the source, from the crate's root.
    paths: Vec<ModulePath>,
}

#[test]
fn modules_use_only_those_above_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut sources = BTreeMap::new();
    collect(&root, &mut Vec::new(), &mut sources);
    assert!(sources.len() > 100, "only {} modules were found", sources.len());
    let found = violations(&sources);
    assert!(found.is_empty(), "{} against the order of modules: {found:#?}", found.len());
}

#[test]
fn order_broken_by_path_or_reexport_is_found() {
    let tree = |below: &str| {
        let files = [
            ("", "pub mod above;\npub mod below;\npub use below::Thing;"),
            ("above", "mod first;\nmod second;\npub use second::Second;"),
            ("above::first", below),
            ("above::second", "use super::first::First;\n#[cfg(test)]\nmod tests {\n    use crate::below::Thing;\n}"),
            ("below", "use crate::above::{self, Second};"),
        ];
        let path = |name: &str| name.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect();
        violations(&files.map(|(name, text)| (path(name), text.to_owned())).into())
    };
    assert!(tree("// use crate::below::Thing;").is_empty());
    let uses = ["use crate::below::Thing;", "use crate::{above, Thing};", "use super::Second;"];
    for wrong in uses.into_iter().chain(["fn f(_: super::second::S) {}"]) {
        assert_eq!(tree(wrong).len(), 1, "{wrong}");
    }
}

/// Reads every module below `folder`.
fn collect(folder: &Path, path: &mut ModulePath, sources: &mut BTreeMap<ModulePath, String>) {
    for entry in fs::read_dir(folder).expect("sources can be listed") {
        let file = entry.expect("sources can be listed").path();
        let name = file.file_stem().and_then(|name| name.to_str()).expect("a name").to_owned();
        if file.is_dir() {
            path.push(name);
            collect(&file, path, sources);
            path.pop();
        } else if file.extension().is_some_and(|extension| extension == "rs") && name != "main" {
            let own = if name == "mod" || name == "lib" { None } else { Some(name) };
            let text = fs::read_to_string(&file).expect("a source can be read");
            sources.insert(path.iter().cloned().chain(own).collect(), text);
        }
    }
}

/// Finds the places where a module uses one that is declared below it.
fn violations(sources: &BTreeMap<ModulePath, String>) -> BTreeSet<String> {
    let modules: BTreeMap<&ModulePath, Module> = sources.iter().map(|(path, text)| (path, parse(path, text))).collect();
    let mut found = BTreeSet::new();
    for (path, module) in &modules {
        for used in &module.paths {
            let used = resolved(used, &modules);
            let Some(fork) = path.iter().zip(&used).position(|(own, other)| own != other) else { continue };
            let Some(parent) = modules.get(&path[..fork].to_vec()) else { continue };
            let place = |name: &String| parent.children.iter().position(|child| child == name);
            if let (Some(own), Some(other)) = (place(&path[fork]), place(&used[fork]))
                && own < other
            {
                found.insert(format!("{} uses {}", path.join("::"), used.join("::")));
            }
        }
    }
    found
}

/// Replaces imported and re-exported names in a path by their own paths, in at most four steps.
fn resolved(path: &ModulePath, modules: &BTreeMap<&ModulePath, Module>) -> ModulePath {
    let mut path = path.clone();
    for _ in 0..4 {
        let import = (0..path.len()).find_map(|at| {
            if modules.contains_key(&path[..=at].to_vec()) {
                return None;
            }
            let target = modules.get(&path[..at].to_vec())?.imports.get(&path[at])?;
            Some(target.iter().chain(&path[at + 1..]).cloned().collect::<ModulePath>())
        });
        path = import.unwrap_or(path);
    }
    path
}

/// Parses the declarations, imports and paths of a module, without its comments and tests.
fn parse(own: &ModulePath, text: &str) -> Module {
    let text = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    let code: String = lines.flat_map(|line| [line, "\n"]).collect();
    let names = code.lines().filter_map(|line| line.trim().strip_suffix(';')?.split_once("mod "));
    let mut module = Module { children: names.map(|(_, name)| name.to_owned()).collect(), ..Module::default() };
    let uses = code.split(';').filter_map(|statement| statement.rsplit_once("use "));
    for (_, tree) in uses.filter(|(before, _)| before.is_empty() || before.ends_with(['\n', ' ', '\t'])) {
        for path in expanded(tree).iter().filter_map(|path| absolute(own, path, &module.children)) {
            module.imports.extend(path.last().map(|name| (name.clone(), path.clone())));
        }
    }
    for start in ["crate::", "super::", "self::"] {
        let outside =
            |at: &usize| !code[..*at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':' || c == '$');
        let places = code.match_indices(start).map(|(at, _)| at).filter(outside);
        for path in places.flat_map(|at| expanded(&code[at..])).collect::<Vec<_>>() {
            module.paths.extend(absolute(own, &path, &module.children));
        }
    }
    module
}

/// The path from the crate's root; `None` for one of another crate.
fn absolute(own: &ModulePath, path: &[String], children: &[String]) -> Option<ModulePath> {
    let mut base = match path.first()?.as_str() {
        "crate" => Vec::new(),
        first if ["self", "super"].contains(&first) || children.iter().any(|child| child == first) => own.clone(),
        _ => return None,
    };
    for part in path {
        match part.as_str() {
            "super" => drop(base.pop()?),
            "crate" | "self" => {}
            part => base.push(part.to_owned()),
        }
    }
    Some(base)
}

/// Expands a tree such as `crate::{a::B, c}` at the start of `text` to its paths.
fn expanded(text: &str) -> Vec<Vec<String>> {
    let text = text.trim_start();
    if let Some(list) = text.strip_prefix('{') {
        let mut depth = 0;
        let mut starts = vec![0];
        for (at, character) in list.char_indices() {
            match character {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => starts.push(at + 1),
                _ => {}
            }
        }
        return starts.into_iter().flat_map(|at| expanded(&list[at..])).collect();
    }
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    let (name, rest) = text.split_at(end);
    match rest.strip_prefix("::") {
        _ if name.is_empty() => Vec::new(),
        Some(rest) => {
            let tails = expanded(rest);
            let tails = if tails.is_empty() { vec![Vec::new()] } else { tails };
            tails.into_iter().map(|tail| std::iter::once(name.to_owned()).chain(tail).collect()).collect()
        }
        None => vec![vec![name.to_owned()]],
    }
}
