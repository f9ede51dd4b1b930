//! Keys of the students' phones, beside the session: a lesson that is continued gives every phone its seat again.

use super::{SessionFolder, io_error, write_error};
use crate::class::Keys;
use crate::lesson::folder::FolderError;
use crate::lesson::lesson::check_pseudonym;
use crate::tokens::is_secret;
use crepitus_files::input;
use crepitus_files::output::{Claim, OutputError, OwnedFolder};

const KEYS: &str = "class.json";

/// Longest file of keys that is read, bytes: that of a class is a twentieth of it.
const KEYS_BYTES: u64 = 64_000;

impl SessionFolder {
    /// Writes the keys; without any, removes the file.
    ///
    /// # Errors
    /// [`FolderError::Write`].
    pub(crate) fn save_keys(&self, keys: &Keys) -> Result<(), FolderError> {
        let path = self.path.join(KEYS);
        if !keys.is_empty() {
            let json = serde_json::to_vec_pretty(keys);
            let json = json.map_err(|error| write_error(&path)(error.into()))?;
            return self.write(KEYS, &json);
        }
        if !path.exists() {
            return Ok(());
        }
        let remove = || -> Result<(), OutputError> {
            let mut folder = OwnedFolder::open(&self.path, Claim::by("lesson"))?;
            folder.remove(KEYS)?;
            folder.compact()
        };
        remove().map_err(|error| write_error(&path)(io_error(error)))
    }

    /// The keys; those of phones that cannot be read are left out, and their seats have to be freed.
    pub(crate) fn keys(&self) -> Keys {
        let text = input::read_to_string(&self.path.join(KEYS), KEYS_BYTES).unwrap_or_default();
        let mut keys: Keys = serde_json::from_str(&text).unwrap_or_default();
        keys.retain(|name, key| check_pseudonym(name).is_ok() && is_secret(key));
        keys
    }
}
