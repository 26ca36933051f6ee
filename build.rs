//! What a build knows of itself: a fingerprint of all that its numbers come from (sources, dependencies, features), for the keys of kept
//! solutions, and in release builds the commit.

use std::hash::{DefaultHasher, Hasher};
use std::path::{Path, PathBuf};

fn main() {
    let root = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let mut files = Vec::new();
    for folder in ["src", "nastran/src"] {
        println!("cargo::rerun-if-changed={folder}");
        collect(&root.join(folder), &mut files);
    }
    files.sort();
    // Another version of a solver or of a transform rounds otherwise. A crate that is a dependency of another crate has no lock file.
    let lock = root.join("Cargo.lock");
    if lock.is_file() {
        println!("cargo::rerun-if-changed=Cargo.lock");
        files.push(lock);
    }
    let mut hasher = DefaultHasher::new();
    for file in &files {
        hasher.write(&std::fs::read(file).unwrap_or_default());
    }
    // Cargo runs this again for other features.
    for feature in features() {
        hasher.write(feature.as_bytes());
        // So that no two lists of names run together into the same bytes.
        hasher.write_u8(0);
    }
    println!(
        "cargo::rustc-env=STRAINBRIDGE_SOURCES={:016x}",
        hasher.finish()
    );
    // Not in builds for tests: every commit would build the crate again.
    let commit = match std::env::var("PROFILE").as_deref() {
        Ok("release") => commit(&root.join(".git")).unwrap_or_default(),
        _ => String::new(),
    };
    println!("cargo::rustc-env=STRAINBRIDGE_COMMIT={commit}");
}

/// Features of the crate that are built, in the order of their names.
fn features() -> Vec<String> {
    let names = std::env::vars_os().filter_map(|(name, _)| name.into_string().ok());
    let mut features: Vec<String> = names.filter(|n| n.starts_with("CARGO_FEATURE_")).collect();
    features.sort();
    features
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, files);
        } else {
            files.push(path);
        }
    }
}

/// The commit that a plain checkout stands at; `None` in an archive or a linked work tree.
fn commit(git: &Path) -> Option<String> {
    let head = git.join("HEAD");
    println!("cargo::rerun-if-changed={}", head.display());
    let text = std::fs::read_to_string(&head).ok()?;
    let Some(name) = text.trim().strip_prefix("ref: ") else {
        return Some(text.trim().to_owned());
    };
    let file = git.join(name);
    println!("cargo::rerun-if-changed={}", file.display());
    if let Ok(hash) = std::fs::read_to_string(&file) {
        return Some(hash.trim().to_owned());
    }
    let packed = std::fs::read_to_string(git.join("packed-refs")).ok()?;
    let line = packed.lines().find(|l| l.ends_with(name))?;
    line.split_whitespace().next().map(str::to_owned)
}
