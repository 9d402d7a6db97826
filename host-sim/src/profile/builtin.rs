use std::path::Path;

use super::parse::UNNAMED;
use super::{Profile, ProfileError, nearest};

/// The profile that counts where none is named.
pub const DEFAULT: &str = "vga-rgb888";

/// The profiles that come with the program: the files of `profiles/`, whose names are the profiles'.
const BUILT_IN: &[(&str, &str)] = &[
    ("vga-rgb888", include_str!("../../profiles/vga-rgb888.toml")),
    ("vga-rgb888-gated", include_str!("../../profiles/vga-rgb888-gated.toml")),
    ("ov7670-vga-rgb565", include_str!("../../profiles/ov7670-vga-rgb565.toml")),
    ("ov7670-qvga-yuv422", include_str!("../../profiles/ov7670-qvga-yuv422.toml")),
    ("vga-gray8", include_str!("../../profiles/vga-gray8.toml")),
    ("vga-raw8", include_str!("../../profiles/vga-raw8.toml")),
    ("vga-raw10", include_str!("../../profiles/vga-raw10.toml")),
    ("vga-raw12", include_str!("../../profiles/vga-raw12.toml")),
    ("bt656-vga-yuv422", include_str!("../../profiles/bt656-vga-yuv422.toml")),
];

/// Largest profile file that is read: the built-in ones have under a thousand bytes.
const MOST_BYTES: u64 = 1 << 20;

/// The names of the built-in profiles, the default first.
pub fn built_in_names() -> impl Iterator<Item = &'static str> {
    BUILT_IN.iter().map(|(name, _)| *name)
}

/// The built-in profiles, the default first.
pub fn built_ins() -> impl Iterator<Item = Profile> {
    BUILT_IN.iter().map(|(name, text)| parse_built_in(name, text))
}

/// # Panics
/// If a file of `profiles/` is wrong, which a test rules out.
fn parse_built_in(name: &str, text: &str) -> Profile {
    Profile::from_toml(text).unwrap_or_else(|error| panic!("profiles/{name}.toml: {error}"))
}

impl Default for Profile {
    /// The built-in profile [`DEFAULT`].
    fn default() -> Self {
        let (name, text) = BUILT_IN[0];
        parse_built_in(name, text)
    }
}

impl Profile {
    /// The built-in profile of this name.
    #[must_use]
    pub fn built_in(name: &str) -> Option<Self> {
        BUILT_IN.iter().find(|(known, _)| *known == name).map(|(name, text)| parse_built_in(name, text))
    }

    /// Reads a profile from a TOML file. One that says no `name` takes the file's.
    ///
    /// # Errors
    /// [`ProfileError::Read`] if the file can't be read or has more than 1 MiB, else [`ProfileError::InFile`] with
    /// what is wrong in it.
    pub fn read(path: &Path) -> Result<Self, ProfileError> {
        use std::io::Read as _;
        let unreadable = |message: String| ProfileError::Read { path: path.to_owned(), message };
        let file = std::fs::File::open(path).map_err(|error| unreadable(error.to_string()))?;
        let mut text = String::new();
        file.take(MOST_BYTES + 1).read_to_string(&mut text).map_err(|error| unreadable(error.to_string()))?;
        if text.len() as u64 > MOST_BYTES {
            return Err(unreadable("longer than 1 MiB, so not a profile".to_owned()));
        }
        let mut profile = Self::from_toml(&text)
            .map_err(|error| ProfileError::InFile { path: path.to_owned(), error: Box::new(error) })?;
        if profile.name == UNNAMED
            && let Some(stem) = path.file_stem()
        {
            profile.name = stem.to_string_lossy().into_owned();
        }
        Ok(profile)
    }

    /// The profile that a user names: a built-in one, else a TOML file.
    ///
    /// # Errors
    /// [`ProfileError::Unknown`] with the nearest name if it is neither, else those of [`Profile::read`].
    pub fn find(name_or_file: &str) -> Result<Self, ProfileError> {
        if let Some(profile) = Self::built_in(name_or_file) {
            return Ok(profile);
        }
        let path = Path::new(name_or_file);
        // A name that looks like a path is one, so the message is about the file.
        let is_path = path.extension().is_some() || path.components().count() > 1;
        if is_path || path.is_file() {
            return Self::read(path);
        }
        Err(ProfileError::Unknown {
            name: name_or_file.to_owned(),
            nearest: nearest(name_or_file, built_in_names()).unwrap_or(DEFAULT),
            known: built_in_names().collect::<Vec<_>>().join(", "),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_the_folder_is_in_the_table_and_right() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles");
        let mut files: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned())
            .collect();
        files.sort();
        let mut names: Vec<_> = built_in_names().collect();
        assert_eq!(names[0], DEFAULT);
        names.sort_unstable();
        assert_eq!(names, files);
        for (profile, name) in built_ins().zip(built_in_names()) {
            assert_eq!(profile.name, name, "a built-in profile is called what its file is");
            assert!(!profile.about.is_empty());
            assert_eq!(Profile::from_toml(&profile.to_toml()).unwrap(), profile, "writing and reading");
        }
    }

    #[test]
    fn a_name_that_is_nothing_names_the_nearest() {
        let error = Profile::find("vga-rgb88").unwrap_err().to_string();
        assert!(error.contains("did you mean `vga-rgb888`?"), "{error}");
        let error = Profile::find("no/such.toml").unwrap_err().to_string();
        assert!(error.starts_with("no/such.toml: "), "{error}");
    }

    #[test]
    fn a_file_gives_its_name_and_its_faults_their_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        std::fs::write(&path, "[frame]\nwidth = 8\nheight = 4\nformat = \"gray8\"\n").unwrap();
        assert_eq!(Profile::read(&path).unwrap().name, "mine");
        std::fs::write(&path, "[frame]\nwidth = 8\nheight = 4\nformat = \"grey8\"\n").unwrap();
        let error = Profile::find(path.to_str().unwrap()).unwrap_err().to_string();
        assert!(error.contains("mine.toml: line 4: ") && error.contains("\"gray8\""), "{error}");
        std::fs::write(&path, [0xFF, 0xFE]).unwrap();
        assert!(matches!(Profile::read(&path), Err(ProfileError::Read { .. })), "not text");
    }
}
