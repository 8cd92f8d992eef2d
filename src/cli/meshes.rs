//! The files that mesh names in a URDF refer to.
//!
//! ```text
//!     package:///NAME/rest   the same as
//!     package://NAME/rest    rest in a folder of package NAME, the first of these that contains this file:
//!                              DIR/NAME, or DIR itself if it is the package    for each --package-path DIR,
//!                              the same                                        for each folder of ROS_PACKAGE_PATH,
//!                              PREFIX/share/NAME                               for each of AMENT_PREFIX_PATH,
//!                              the same as for DIR                             for each folder above the URDF file,
//!                            or if there is no package NAME, rest in the first of these folders that contains it,
//!                            which is a guess if that is a folder above the URDF file
//!     file:///path, /path    that path
//!     path                   from the folder of the URDF file
//! ```
//!
//! A folder is a package if its own name or the name in its package.xml is that of the package. `model://` (Gazebo)
//! means the same as `package://`, and a backslash the same as a slash. `%20` means a space unless a file has the
//! percent sign in its name. Only regular files are opened, and only names that do not leave their package.

use super::input::InputFile;
use crate::description::{Description, Fetched};
use percent_encoding::percent_decode_str;
use std::path::{Component, Path, PathBuf};

/// The folders in which meshes are searched.
pub struct Meshes {
    /// The folder of the URDF file.
    folder: PathBuf,
    /// Folders that are packages or contain packages, in the order of the search.
    roots: Vec<PathBuf>,
    /// The number of roots that are not above the URDF file.
    given: usize,
}

impl Meshes {
    /// Creates the search for the URDF file `robot`. Packages are first searched in `package_path`.
    pub fn of(robot: &Path, package_path: &[PathBuf]) -> Self {
        let folder = robot.parent().unwrap_or(Path::new("")).to_owned();
        let mut roots = package_path.to_vec();
        roots.extend(listed("ROS_PACKAGE_PATH"));
        roots.extend(listed("AMENT_PREFIX_PATH").into_iter().map(|prefix| prefix.join("share")));
        let given = roots.len();
        let whole = Path::new(".").join(&folder).canonicalize().unwrap_or_default();
        roots.extend(whole.ancestors().map(Path::to_owned));
        Self { folder, roots, given }
    }

    /// Reads the collision meshes of the URDF file, with a caution about packages whose folder is guessed.
    pub fn read(&self, description: &mut Description) {
        let mut guessed = Vec::new();
        description.read_meshes(|name| self.fetch(name, &mut guessed));
        description.guessed = guessed;
    }

    /// Reads the file that the URDF calls `name`. A guess of its package's folder is appended to `guessed`.
    ///
    /// # Errors
    /// Returns the reason if the file is not found, cannot be read, or its name leaves its package.
    fn fetch(&self, name: &str, guessed: &mut Vec<String>) -> Fetched {
        let as_written = name.replace('\\', "/");
        let decoded = percent_decode_str(&as_written).decode_utf8_lossy().into_owned();
        if [&as_written, &decoded].into_iter().any(|name| leaves(name)) {
            return Err("its name leaves its package, as no name may".into());
        }
        let found = [&as_written, &decoded].into_iter().find_map(|name| self.find(name, guessed));
        let path = found.ok_or_else(|| self.missing(&decoded))?;
        InputFile::read(&path, InputFile::LARGE).map(|input| input.bytes).map_err(|error| error.reason().to_string())
    }

    fn find(&self, name: &str, guessed: &mut Vec<String>) -> Option<PathBuf> {
        let Some((package, path)) = package_and_path(name) else {
            return Some(self.folder.join(name.strip_prefix("file://").unwrap_or(name))).filter(|path| path.is_file());
        };
        let within = |folder: &PathBuf| folder.join(path).is_file();
        if self.packages(package).next().is_some() {
            return self.packages(package).find(within).map(|folder| folder.join(path));
        }
        // Packages are copied to folders of other names.
        let at = self.roots.iter().position(within)?;
        let guess = format!("{package} in {}", self.roots[at].display());
        if at >= self.given && !guessed.contains(&guess) {
            guessed.push(guess);
        }
        Some(self.roots[at].join(path))
    }

    /// Returns the folders of a package.
    fn packages<'a>(&'a self, name: &'a str) -> impl Iterator<Item = PathBuf> + 'a {
        // The folder of the URDF file is one of the roots.
        let inside = move |root: &PathBuf| {
            let below = root.join(name);
            if below.is_dir() { Some(below) } else { is_package(root, name).then(|| root.clone()) }
        };
        self.roots.iter().filter_map(inside)
    }

    fn missing(&self, name: &str) -> String {
        match package_and_path(name) {
            Some((package, _)) if self.packages(package).next().is_none() => {
                let given = self.roots[..self.given].iter().map(|root| root.display().to_string());
                let looked: Vec<String> = given.chain(["a folder above the URDF file".to_owned()]).collect();
                let looked = looked.join(" or ");
                format!("neither package {package} nor this file is in {looked}: name its folder by `package_path`")
            }
            Some((package, _)) => format!("no such file in package {package}"),
            None if name.contains("://") && !name.starts_with("file://") => "no file of this machine".to_owned(),
            None => "no such file".to_owned(),
        }
    }
}

fn listed(variable: &str) -> Vec<PathBuf> {
    let all = std::env::var_os(variable).unwrap_or_default();
    std::env::split_paths(&all).filter(|folder| !folder.as_os_str().is_empty()).collect()
}

/// Splits a name like `package://NAME/path` into package and path; `None` for other names.
fn package_and_path(name: &str) -> Option<(&str, &str)> {
    let rest = name.strip_prefix("package://").or_else(|| name.strip_prefix("model://"))?;
    let rest = rest.trim_start_matches('/');
    let (package, path) = rest.split_once('/').unwrap_or((rest, ""));
    Some((package, path.trim_start_matches('/')))
}

/// Returns whether the path of a name leaves its package, even if it comes back.
fn leaves(name: &str) -> bool {
    let Some((package, path)) = package_and_path(name) else { return false };
    let depth = Path::new(path).components().try_fold(0_usize, |depth, component| match component {
        Component::Normal(_) => Some(depth + 1),
        Component::CurDir => Some(depth),
        Component::ParentDir => depth.checked_sub(1),
        Component::RootDir | Component::Prefix(_) => None,
    });
    depth.is_none() || matches!(package, "." | "..")
}

/// Returns whether `folder` is the package `name`, by its own name or by the name in its package.xml.
fn is_package(folder: &Path, name: &str) -> bool {
    let in_manifest = || {
        let manifest = Some(folder.join("package.xml")).filter(|manifest| manifest.is_file())?;
        let manifest = InputFile::read(&manifest, InputFile::SMALL).ok()?;
        let text = String::from_utf8_lossy(&manifest.bytes);
        let (declared, _) = text.split_once("<name>")?.1.split_once("</name>")?;
        Some(declared.trim() == name)
    };
    folder.file_name().is_some_and(|file_name| file_name == name) || in_manifest() == Some(true)
}
