//! The journal of a page, in the browser's cache storage.
//!
//! Some time after a stroke the version is written as a `.groom` file, with its name and time before it. A later version
//! replaces it, and saving removes it. All pages of one origin share it.

use super::age;
use crate::task;
use std::{cell::Cell, path::Path, rc::Rc, sync::Arc, time::Duration};
use tresses::groom::edit::GroomDocument;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;

/// Name of the storage, and of the version in it.
const STORAGE: &str = "tresses";
const KEY: &str = "left.groom";
/// Time without a stroke after which a version is written, milliseconds: the page stands still meanwhile.
const QUIET: i32 = 1500;

/// The journal of one studio.
#[derive(Debug)]
pub struct BrowserJournal {
    name: String,
    /// Hash of the version to write, or that was last written.
    last: Rc<Cell<Option<u64>>>,
}

/// Groomed hair that an earlier page has left.
#[derive(Clone, Debug)]
pub struct BrowserGroom {
    /// Name of the hair.
    pub name: String,
    /// Time of the last stroke, milliseconds since 1970.
    written: f64,
    file: Arc<[u8]>,
}

impl BrowserJournal {
    /// Creates the journal of hair named `name`.
    pub fn new(name: &str, _: Option<BrowserGroom>) -> Self {
        Self { name: name.into(), last: Rc::default() }
    }

    /// Writes `document`, whose hash is `hash`, unless another follows soon.
    ///
    /// # Errors
    /// None: errors of the browser go to its console.
    pub fn keep(&mut self, document: &GroomDocument, hash: u64) -> std::io::Result<()> {
        self.last.set(Some(hash));
        let (last, document, name) = (self.last.clone(), document.clone(), self.name.clone());
        task::spawn(move || async move {
            task::pause(QUIET).await;
            if last.get() == Some(hash)
                && let Err(error) = write(&name, &document.write()).await
            {
                web_sys::console::warn_2(&"the journal cannot be written".into(), &error);
            }
        });
        Ok(())
    }

    /// Notes that the user has saved the version with this hash.
    pub fn saved(&mut self, hash: u64) {
        if self.last.get() == Some(hash) {
            self.last.set(None);
            forget();
        }
    }
}

impl BrowserGroom {
    /// Returns how long ago the last stroke was, in words.
    pub fn age(&self) -> String {
        let seconds = (js_sys::Date::now() - self.written) / 1e3;
        age(Duration::from_secs_f64(seconds.max(0.0)))
    }

    /// Reads the hair.
    ///
    /// # Errors
    /// Fails if it is damaged.
    pub fn read(&self) -> anyhow::Result<GroomDocument> {
        Ok(GroomDocument::read(Path::new(&self.name), &self.file)?)
    }

    /// Removes the file.
    pub fn remove(&self) {
        forget();
    }
}

/// Returns the storage.
async fn storage() -> Result<web_sys::Cache, JsValue> {
    let window = web_sys::window().ok_or("there is no window")?;
    JsFuture::from(window.caches()?.open(STORAGE)).await?.dyn_into()
}

/// Writes a version: the time, the length of the name, the name, and the file.
async fn write(name: &str, file: &[u8]) -> Result<(), JsValue> {
    let mut bytes = js_sys::Date::now().to_le_bytes().to_vec();
    bytes.extend((name.len() as u32).to_le_bytes());
    bytes.extend(name.as_bytes());
    bytes.extend(file);
    let response = web_sys::Response::new_with_opt_u8_array(Some(&mut bytes))?;
    JsFuture::from(storage().await?.put_with_str(KEY, &response)).await?;
    Ok(())
}

/// Reads the version that an earlier page has left; `None` without one.
async fn read() -> Result<Option<BrowserGroom>, JsValue> {
    let found = JsFuture::from(storage().await?.match_with_str(KEY)).await?;
    let Ok(response) = found.dyn_into::<web_sys::Response>() else { return Ok(None) };
    let bytes = js_sys::Uint8Array::new(&JsFuture::from(response.array_buffer()?).await?).to_vec();
    let left = bytes.split_first_chunk::<8>().and_then(|(written, rest)| {
        let (length, rest) = rest.split_first_chunk::<4>()?;
        let (name, file) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        let name = String::from_utf8_lossy(name).into_owned();
        Some(BrowserGroom { name, written: f64::from_le_bytes(*written), file: file.into() })
    });
    Ok(left)
}

fn forget() {
    task::spawn(|| async {
        if let Ok(storage) = storage().await {
            // It may be gone already.
            let _ = JsFuture::from(storage.delete_with_str(KEY)).await;
        }
    });
}

/// Calls `tell` with groomed hair that an earlier page has left, if there is any.
pub fn find(tell: impl FnOnce(BrowserGroom) + 'static) {
    task::spawn(move || async move {
        match read().await {
            Ok(Some(left)) => tell(left),
            Ok(None) => {}
            // Without storage, as in private windows, there is nothing to recover.
            Err(error) => web_sys::console::warn_2(&"the journal cannot be read".into(), &error),
        }
    });
}
