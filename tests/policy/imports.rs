//! Within each folder at the top of `src/`, imports never form a cycle, so that its files can be read one after the other.
//! Two types never have the same name.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The path of a module below the crate, such as `["motion", "phase"]`.
type Module = Vec<String>;

/// The code of each module, without comments and unit tests.
struct Crate(BTreeMap<Module, String>);

impl Crate {
    fn read() -> Crate {
        let mut modules = BTreeMap::new();
        read_below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &[], &mut modules);
        Crate(modules)
    }

    /// Returns the paths that a module imports, from the root of the crate, and whether it gives them on to others.
    fn imports(&self, module: &Module) -> Vec<(Module, bool)> {
        let mut all = Vec::new();
        for statement in self.0[module].split(';') {
            let Some((before, tree)) = statement.rsplit_once("use ") else { continue };
            let line = before.lines().last().unwrap_or_default().trim();
            if line.is_empty() || line.starts_with("pub") {
                let found = paths(tree).into_iter().filter_map(|path| self.absolute(module, &path));
                all.extend(found.map(|path| (path, line.starts_with("pub"))));
            }
        }
        all
    }

    fn absolute(&self, module: &Module, path: &str) -> Option<Module> {
        let mut steps = path.split("::").map(str::trim).peekable();
        let mut from = match *steps.peek()? {
            "crate" => Vec::new(),
            "super" | "self" => module.clone(),
            first => {
                let below = [module.clone(), vec![first.to_owned()]].concat();
                return self.0.contains_key(&below).then(|| join(module, steps));
            }
        };
        while let Some(step) = steps.next_if(|step| ["crate", "super", "self"].contains(step)) {
            if step == "super" {
                from.pop();
            }
        }
        Some(join(&from, steps))
    }

    /// Returns the module that defines what a path names; modules may import it from each other.
    fn definition(&self, path: &Module, passed: usize) -> Module {
        let known = (0..=path.len()).rev().map(|length| path[..length].to_vec());
        let module = known.into_iter().find(|part| self.0.contains_key(part)).unwrap_or_default();
        let Some(name) = path.get(module.len()) else { return module };
        let same = |(import, _): &(Module, bool)| import.len() > 1 && import.last() == Some(name);
        match self.imports(&module).into_iter().find(same) {
            Some((import, _)) if passed < 5 => self.definition(&import, passed + 1),
            _ => module,
        }
    }
}

fn join<'a>(from: &Module, steps: impl Iterator<Item = &'a str>) -> Module {
    from.iter().cloned().chain(steps.map(str::to_owned)).collect()
}

fn read_below(folder: &Path, module: &[String], modules: &mut BTreeMap<Module, String>) {
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let below = [module, std::slice::from_ref(&name)].concat();
        if path.is_dir() {
            read_below(&path, &below, modules);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let text = fs::read_to_string(&path).expect("a source file");
            let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
            let lines = code.lines().map(|line| line.split("//").next().unwrap_or_default());
            let path =
                if ["mod", "lib"].contains(&name.as_str()) { module.to_vec() } else { below };
            modules.insert(path, lines.collect::<Vec<_>>().join("\n"));
        }
    }
}

/// Expands `a::{b, c::{d, e}}` into `a::b`, `a::c::d` and `a::c::e`.
fn paths(tree: &str) -> Vec<String> {
    let Some((before, inside)) = tree.split_once('{') else {
        return vec![tree.split(" as ").next().unwrap_or_default().trim().to_owned()];
    };
    let inside = inside.rsplit_once('}').map_or(inside, |(inside, _)| inside);
    let mut depth = 0;
    let parts = inside.split(|letter| {
        depth += i32::from(letter == '{') - i32::from(letter == '}');
        letter == ',' && depth == 0
    });
    let parts = parts.filter(|part| !part.trim().is_empty());
    parts.flat_map(paths).map(|path| format!("{}{path}", before.trim())).collect()
}

#[test]
fn no_imports_form_a_cycle() {
    let all = Crate::read();
    assert!(all.0.len() > 400, "{} files", all.0.len());
    let mut left: BTreeMap<&Module, BTreeSet<Module>> = BTreeMap::new();
    for module in all.0.keys().filter(|module| !module.is_empty()) {
        // What a folder gives on to others is no use of its own.
        let is_folder = |other: &Module| other.len() > module.len() && other.starts_with(module);
        let is_folder = all.0.keys().any(is_folder);
        let imports =
            all.imports(module).into_iter().filter(|(_, given_on)| !(is_folder && *given_on));
        let defined = imports.map(|(path, _)| all.definition(&path, 0));
        let in_folder = defined.filter(|other| other.first() == module.first() && other != module);
        left.insert(module, in_folder.collect());
    }
    assert!(left.values().map(BTreeSet::len).sum::<usize>() > 800, "few imports are found");
    loop {
        let waiting: BTreeSet<Module> = left.keys().map(|module| (*module).clone()).collect();
        let before = left.len();
        let imported: BTreeSet<Module> = left.values().flatten().cloned().collect();
        left.retain(|module, imports| {
            imported.contains(*module) && imports.iter().any(|other| waiting.contains(other))
        });
        if left.len() == before {
            break;
        }
    }
    assert!(left.is_empty(), "files in cycles of imports, or between them: {:?}", left.keys());
}

/// Each command has its `Arguments`.
#[test]
fn no_two_types_have_one_name() {
    let mut places: BTreeMap<String, Vec<Module>> = BTreeMap::new();
    for (module, code) in Crate::read().0 {
        for line in code.lines().filter(|line| line.starts_with(['p', 's', 'e', 't'])) {
            let words = line
                .split_whitespace()
                .skip_while(|word| word.starts_with("pub") || word.ends_with(')'));
            let words: Vec<&str> = words.collect();
            if let ["struct" | "enum" | "trait", name, ..] = words[..] {
                let name = name.split(|letter: char| !letter.is_alphanumeric()).next();
                places.entry(name.unwrap_or_default().to_owned()).or_default().push(module.clone());
            }
        }
    }
    assert!(places.len() > 700, "{} types", places.len());
    places.retain(|name, places| places.len() > 1 && name != "Arguments");
    assert!(places.is_empty(), "{places:?}");
}
