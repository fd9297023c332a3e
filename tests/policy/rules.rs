//! The rules of `deny.toml` that need no database, and their violations.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;
use spdx::{Expression, Licensee, ParseMode};

/// The part of `deny.toml` that is enforced here; the rest is for cargo-deny.
#[derive(Debug, Deserialize)]
pub struct Policy {
    graph: Graph,
    licenses: Licenses,
    bans: Bans,
    sources: Sources,
}

#[derive(Debug, Deserialize)]
struct Graph {
    targets: Vec<String>,
}

#[derive(Debug, Deserialize)]
struct Licenses {
    allow: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
struct Bans {
    multiple_versions: String,
    skip: Vec<Exception>,
    deny: Vec<Exception>,
}

#[derive(Debug, Deserialize)]
struct Exception {
    #[serde(rename = "crate")]
    name: String,
    reason: String,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
struct Sources {
    unknown_registry: String,
    unknown_git: String,
    allow_registry: Vec<String>,
    allow_git: Vec<String>,
}

/// A package that is built for the program or its tests.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Built {
    pub name: String,
    pub version: String,
    pub license: String,
}

/// A package in `Cargo.lock`, for any platform.
#[derive(Clone, Debug, Deserialize)]
pub struct Locked {
    pub name: String,
    pub version: String,
    pub source: Option<String>,
}

impl Policy {
    /// Panics unless the file denies what is enforced here, because the meanings would differ
    /// otherwise.
    pub fn parse(text: &str) -> Self {
        let policy: Policy =
            basic_toml::from_str(text).unwrap_or_else(|error| panic!("deny.toml: {error}"));
        let Policy { bans, sources, .. } = &policy;
        for (key, level) in [
            ("multiple-versions", &bans.multiple_versions),
            ("unknown-registry", &sources.unknown_registry),
            ("unknown-git", &sources.unknown_git),
        ] {
            assert_eq!(level, "deny", "deny.toml: {key}");
        }
        policy
    }

    pub fn targets(&self) -> &[String] {
        &self.graph.targets
    }

    /// Returns the packages with a licence that is not allowed.
    pub fn licences(&self, built: &BTreeSet<Built>) -> Vec<String> {
        let allowed: Vec<Licensee> = self
            .licenses
            .allow
            .iter()
            .map(|name| Licensee::parse(name).unwrap_or_else(|error| panic!("{name}: {error}")))
            .collect();
        let usable = |license: &str| {
            // Lax: old crates write MIT/Apache-2.0.
            let expression = Expression::parse_mode(license, ParseMode::LAX).ok();
            expression.is_some_and(|expression| {
                expression.evaluate(|wanted| allowed.iter().any(|ours| ours.satisfies(wanted)))
            })
        };
        built
            .iter()
            .filter(|package| !usable(&package.license))
            .map(|package| {
                format!(
                    "{} {}: licence {:?} is none of [licenses] allow",
                    package.name, package.version, package.license
                )
            })
            .collect()
    }

    /// Returns the packages that are built in several versions without an exception.
    pub fn duplicates(&self, built: &BTreeSet<Built>) -> Vec<String> {
        let mut versions: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for package in built {
            if !self.bans.skip.iter().any(|ban| ban.is(&package.name, &package.version)) {
                versions.entry(&package.name).or_default().push(&package.version);
            }
        }
        let several = versions.into_iter().filter(|(_, versions)| versions.len() > 1);
        several
            .map(|(name, versions)| {
                format!("{name}: in versions {}; one, or [bans] skip", versions.join(" and "))
            })
            .collect()
    }

    /// Returns the exceptions that are no longer needed, or that give no reason.
    pub fn needless(&self, locked: &[Locked]) -> Vec<String> {
        let gone = |ban: &&Exception| {
            !locked.iter().any(|package| ban.is(&package.name, &package.version))
        };
        let needless = self.bans.skip.iter().filter(gone);
        let needless = needless.map(|ban| format!("{}: in [bans] skip, but not in use", ban.name));
        let all = self.bans.skip.iter().chain(&self.bans.deny);
        let unexplained = all.filter(|ban| ban.reason.trim().is_empty());
        needless.chain(unexplained.map(|ban| format!("{}: without a reason", ban.name))).collect()
    }

    /// Returns the denied packages, including those for other platforms or for tests.
    pub fn denied(&self, locked: &[Locked]) -> Vec<String> {
        let why = |package: &Locked| {
            let denied = self.bans.deny.iter().find(|ban| ban.is(&package.name, &package.version));
            denied
                .map(|ban| format!("{} {}: denied, {}", package.name, package.version, ban.reason))
        };
        locked.iter().filter_map(why).collect()
    }

    /// Returns the packages from registries that are not allowed; a package without a source
    /// belongs to this checkout.
    pub fn sources(&self, locked: &[Locked]) -> Vec<String> {
        let allowed = |source: &str| {
            let is = |list: &[String], place: &str| list.iter().any(|known| known == place);
            match source.split_once('+') {
                Some(("registry", place)) => is(&self.sources.allow_registry, place),
                Some(("git", place)) => {
                    let place = place.split(['?', '#']).next().unwrap_or_default();
                    is(&self.sources.allow_git, place)
                }
                _ => false,
            }
        };
        let foreign = locked.iter().filter_map(|package| {
            let source = package.source.as_deref().filter(|source| !allowed(source))?;
            Some(format!("{} {}: from {source}", package.name, package.version))
        });
        foreign.collect()
    }
}

impl Exception {
    /// `name` matches all versions, `name@version` one.
    fn is(&self, name: &str, version: &str) -> bool {
        match self.name.split_once('@') {
            Some((known, of)) => known == name && of == version,
            None => self.name == name,
        }
    }
}
