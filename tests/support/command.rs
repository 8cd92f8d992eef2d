//! Runs the real binary.

use std::path::Path;
use std::time::Duration;

use assert_cmd::Command;
use serde_json::Value;

/// Exit status and output of a run.
pub struct Run {
    arguments: Vec<std::ffi::OsString>,
    pub status: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    /// The lines of standard output as JSON.
    pub fn lines(&self) -> Vec<Value> {
        self.stdout.lines().map(|line| serde_json::from_str(line).expect("a line of JSON")).collect()
    }

    /// The only line of standard output as JSON.
    #[track_caller]
    pub fn line(&self) -> Value {
        assert_eq!(self.stdout.lines().count(), 1, "{:?}\n{}{}", self.arguments, self.stdout, self.stderr);
        serde_json::from_str(&self.stdout).expect("JSON")
    }

    /// Returns the run, which must have ended with status 0.
    #[track_caller]
    pub fn well(self) -> Self {
        assert_eq!(self.status, 0, "{:?}\n{}", self.arguments, self.stderr);
        self
    }

    /// Returns standard output of the run, which must have ended with status 0 and nothing on standard error.
    #[track_caller]
    pub fn text(self) -> String {
        assert_eq!((self.status, self.stderr.as_str()), (0, ""), "{:?}", self.arguments);
        self.stdout
    }

    /// Returns standard error of the run, which must have ended with this status and nothing on standard output.
    #[track_caller]
    pub fn refusal(self, status: i32) -> String {
        assert_eq!((self.status, self.stdout.as_str()), (status, ""), "{:?}\n{}", self.arguments, self.stderr);
        self.stderr
    }

    /// Like [`Self::refusal`], and asserts that standard error contains `words`.
    #[track_caller]
    pub fn refusal_with(self, status: i32, words: &str) {
        let arguments = self.arguments.clone();
        let stderr = self.refusal(status);
        assert!(stderr.contains(words), "{arguments:?}: {stderr}");
    }
}

pub fn heelstrike(args: &[&str]) -> Run {
    heelstrike_reads(args, "")
}

pub fn heelstrike_reads(args: &[&str], stdin: impl Into<Vec<u8>>) -> Run {
    finished(command().args(args).write_stdin(stdin))
}

pub fn command() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_heelstrike"));
    for variable in ["NO_COLOR", "CLICOLOR_FORCE", "ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"] {
        command.env_remove(variable);
    }
    command.timeout(Duration::from_secs(600));
    command
}

pub fn finished(command: &mut Command) -> Run {
    let output = command.output().expect("the command runs");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    let arguments = command.get_args().map(std::ffi::OsStr::to_owned).collect();
    let status = output.status.code().expect("no signal");
    Run { arguments, status, stdout: text(output.stdout), stderr: text(output.stderr) }
}

/// The text of a file of this repository.
#[track_caller]
pub fn read(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A path for a file, in a folder that only the running test uses.
pub fn place(name: &str) -> String {
    let test = std::thread::current().name().unwrap_or("several").replace("::", "-");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder.join(name).to_str().expect("UTF-8").to_owned()
}

/// Writes `content` to [`place`] and returns the path.
pub fn file(name: &str, content: impl AsRef<[u8]>) -> String {
    let path = place(name);
    std::fs::write(&path, content).expect("a file");
    path
}
