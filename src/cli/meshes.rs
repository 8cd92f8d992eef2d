//! Names of mesh files in a URDF -> files.
//!
//! ```text
//!     package:///path        from the folder of the URDF file, or from a --package-path DIR or the folders after it
//!     package://NAME/rest    rest in the folder of package NAME, which is the first that is there of
//!                              DIR/NAME, or DIR itself if it is the package    for each --package-path DIR,
//!                              the same for each folder of ROS_PACKAGE_PATH,
//!                              PREFIX/share/NAME                               for each of AMENT_PREFIX_PATH,
//!                              the same as for DIR                             for each folder above the URDF file
//!     file:///path, /path    that path
//!     path                   from the folder of the URDF file
//! ```
//!
//! A folder is a package if its own name or its package.xml says so. `model://` (Gazebo) means the same as
//! `package://`, backslashes the same as slashes, and `%20` a space unless a file has the percent sign in its name.
//! Only regular files are opened, and none outside its package.

use super::input::InputFile;
use crate::description::Fetched;
use percent_encoding::percent_decode_str;
use std::path::{Component, Path, PathBuf};

/// Where meshes are looked for.
pub struct Meshes {
    /// The URDF file's folder.
    folder: PathBuf,
    /// Folders that are packages or hold them, in the order of the search.
    roots: Vec<PathBuf>,
}

impl Meshes {
    /// Those of the URDF file `robot`; packages are first looked for in `package_path`.
    pub fn of(robot: &Path, package_path: &[PathBuf]) -> Self {
        let folder = robot.parent().unwrap_or(Path::new("")).to_owned();
        let mut roots = package_path.to_vec();
        roots.extend(listed("ROS_PACKAGE_PATH"));
        roots.extend(listed("AMENT_PREFIX_PATH").into_iter().map(|prefix| prefix.join("share")));
        let whole = Path::new(".").join(&folder).canonicalize().unwrap_or_default();
        roots.extend(whole.ancestors().map(Path::to_owned));
        Self { folder, roots }
    }

    /// The file that a URDF calls `name`.
    pub fn fetch(&self, name: &str) -> Fetched {
        let as_written = name.replace('\\', "/");
        let decoded = percent_decode_str(&as_written).decode_utf8_lossy().into_owned();
        if [&as_written, &decoded].into_iter().any(|name| leaves(name)) {
            return Err("its name leaves its package, as no name may".into());
        }
        let found = [&as_written, &decoded].into_iter().find_map(|name| self.find(name));
        let path = found.ok_or_else(|| self.missing(&decoded))?;
        InputFile::read(&path, InputFile::LARGE).map(|input| input.bytes).map_err(|error| error.reason().to_string())
    }

    fn find(&self, name: &str) -> Option<PathBuf> {
        let Some((package, path)) = package_and_path(name) else {
            return Some(self.folder.join(name.strip_prefix("file://").unwrap_or(name))).filter(|path| path.is_file());
        };
        self.packages(package).map(|folder| folder.join(path)).find(|path| path.is_file())
    }

    /// The folders of a package.
    fn packages<'a>(&'a self, name: &'a str) -> impl Iterator<Item = PathBuf> + 'a {
        // The folder of the file is a root, too.
        let inside = move |root: &PathBuf| {
            if name.is_empty() {
                return Some(root.clone());
            }
            let below = root.join(name);
            if below.is_dir() { Some(below) } else { is_package(root, name).then(|| root.clone()) }
        };
        self.roots.iter().filter_map(inside)
    }

    fn missing(&self, name: &str) -> String {
        match package_and_path(name) {
            Some(("", _)) => "no such file, and its name has no package".to_owned(),
            Some((package, _)) if self.packages(package).next().is_none() => {
                format!("package {package} is not here: name the folder that holds it by `package_path`")
            }
            Some((package, _)) => format!("no such file in package {package}"),
            None if name.contains("://") && !name.starts_with("file://") => "no file of this machine".to_owned(),
            None => "no such file".to_owned(),
        }
    }
}

/// The folders that an environment variable lists.
fn listed(variable: &str) -> Vec<PathBuf> {
    let all = std::env::var_os(variable).unwrap_or_default();
    std::env::split_paths(&all).filter(|folder| !folder.as_os_str().is_empty()).collect()
}

/// Package and path of a name like `package://NAME/path`.
fn package_and_path(name: &str) -> Option<(&str, &str)> {
    let rest = name.strip_prefix("package://").or_else(|| name.strip_prefix("model://"))?;
    let (package, path) = rest.split_once('/').unwrap_or((rest, ""));
    Some((package, path.trim_start_matches('/')))
}

/// Whether a name leads out of its package on the way.
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

/// Whether `folder` is the package of that name.
fn is_package(folder: &Path, name: &str) -> bool {
    if folder.file_name().is_some_and(|own| own == name) {
        return true;
    }
    let manifest = folder.join("package.xml");
    if !manifest.is_file() {
        return false;
    }
    let Ok(manifest) = InputFile::read(&manifest, InputFile::SMALL) else { return false };
    let text = String::from_utf8_lossy(&manifest.bytes);
    let own = text.split_once("<name>").and_then(|(_, rest)| rest.split_once("</name>"));
    own.is_some_and(|(own, _)| own.trim() == name)
}
