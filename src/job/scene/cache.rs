//! Results that are kept from one run to the next, by the digest of all that they follow from.
//!
//! An entry is a file of blocks, named after its key, and begins with the digest of what follows: one that was cut off or changed is
//! seen to be so, and made anew. Entries appear whole, under temporary names that are renamed, so that several
//! processes may share a folder: they write the same bytes. Excluded: what belongs into a key, and getting rid of old entries; the
//! folder may be deleted at any time.

use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::export;
use crate::job::certificate::sha256;

/// The first bytes of an entry. Another layout has another number.
const MAGIC: &[u8] = b"openwork cache 1\n";
/// Hexadecimal digits of a digest.
const DIGEST: usize = 64;

/// A folder of entries.
#[derive(Debug, Clone)]
pub(super) struct Cache {
    folder: PathBuf,
}

/// What a result follows from, as a name for it.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct Key(String);

impl Key {
    /// The key of all `parts` together, in this order, for this version of the program.
    pub(super) fn of<'p>(parts: impl IntoIterator<Item = &'p [u8]>) -> Self {
        let mut digest = Sha256::new();
        let version = env!("CARGO_PKG_VERSION").as_bytes();
        for part in [MAGIC, version].into_iter().chain(parts) {
            // With its length, so that no part runs into the next.
            digest.update((part.len() as u64).to_le_bytes());
            digest.update(part);
        }
        Self(digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
    }

    /// The digits.
    pub(super) fn as_bytes(&self) -> &[u8] {
        self.0.as_bytes()
    }
}

impl Cache {
    /// The cache in `folder`, which need not exist.
    pub(super) fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned() }
    }

    fn file(&self, key: &Key) -> PathBuf {
        self.folder.join(format!("{}.owc", key.0))
    }

    /// The blocks under a key; `None` where there are none, or what is there is not what was written.
    pub(super) fn get(&self, key: &Key) -> Option<Vec<Vec<u8>>> {
        let bytes = std::fs::read(self.file(key)).ok()?;
        let rest = bytes.strip_prefix(MAGIC)?;
        let (digest, mut rest) = rest.split_at_checked(DIGEST)?;
        if sha256(rest).as_bytes() != digest {
            return None;
        }
        let mut blocks = Vec::new();
        while !rest.is_empty() {
            let (length, after) = rest.split_first_chunk::<8>()?;
            let (block, after) =
                after.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
            blocks.push(block.to_vec());
            rest = after;
        }
        Some(blocks)
    }

    /// Keeps blocks under a key.
    ///
    /// # Errors
    /// Why the entry cannot be written, for a note: the result itself is not in doubt.
    pub(super) fn put(&self, key: &Key, blocks: &[&[u8]]) -> Result<(), String> {
        let mut content = Vec::new();
        for block in blocks {
            content.extend((block.len() as u64).to_le_bytes());
            content.extend_from_slice(block);
        }
        let bytes = [MAGIC, sha256(&content).as_bytes(), &content].concat();
        let tell =
            |error: &dyn std::fmt::Display| format!("nothing is kept in {}: {error}", self.folder.display());
        std::fs::create_dir_all(&self.folder).map_err(|error| tell(&error))?;
        let staged = export::stage(&self.file(key), &bytes).map_err(|error| tell(&error))?;
        export::persist_all(vec![staged]).map_err(|error| tell(&error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder of its own for a test, which is gone afterwards.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("openwork-{name}-{}", std::process::id()));
            std::fs::create_dir_all(&folder).unwrap();
            Self(folder)
        }

        fn path(&self) -> &Path {
            &self.0
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn entries_come_back_whole_or_not_at_all() {
        let folder = Folder::new("entries");
        let cache = Cache::new(&folder.path().join("new/cache"));
        let key = Key::of([&b"a"[..], b"bc"]);
        assert_ne!(key, Key::of([&b"ab"[..], b"c"]));
        assert_eq!(cache.get(&key), None);
        cache.put(&key, &[b"first", b"", b"third"]).unwrap();
        let blocks = cache.get(&key).unwrap();
        assert_eq!(blocks, [b"first".to_vec(), Vec::new(), b"third".to_vec()]);
        let whole = std::fs::read(cache.file(&key)).unwrap();
        for end in [0, 5, MAGIC.len() + 3, whole.len() - 1] {
            std::fs::write(cache.file(&key), &whole[..end]).unwrap();
            assert_eq!(cache.get(&key), None, "{end}");
        }
        let mut changed = whole.clone();
        *changed.last_mut().unwrap() ^= 1;
        std::fs::write(cache.file(&key), &changed).unwrap();
        assert_eq!(cache.get(&key), None);
        cache.put(&key, &[b"anew"]).unwrap();
        assert_eq!(cache.get(&key).unwrap(), [b"anew".to_vec()]);
        assert_eq!(std::fs::read_dir(folder.path().join("new/cache")).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_that_cannot_be_is_told() {
        let folder = Folder::new("no-folder");
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        let told = Cache::new(&file).put(&Key::of([&b"a"[..]]), &[]).unwrap_err();
        assert!(told.contains("nothing is kept in"), "{told}");
    }
}
