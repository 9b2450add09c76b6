//! Files: content hashes, and writing so that nothing half-written stays behind.

pub mod chosen; // files whose names this program chooses, below a user's folder
pub mod environment; // environment variables, and programs in `PATH`
mod error; // errors of files
mod folder; // folders made whole, files copied into them
mod hash; // SHA-256
pub mod inputs; // what was read, which no output replaces
mod journal; // files that take their places together
pub mod limit; // the largest file that may be written
mod path; // folders, names, free places
mod place; // what lies where an output is to go
mod read; // files read whole, with limits
mod staged; // files under temporary names
mod state; // a file as it was when it was read
mod write; // files written whole or not at all

pub use error::{FileError, plain};
pub use folder::{copy, link, make_folder, make_named_folder, remove_if_empty};
pub use hash::{hashed, sha256_hex, sha256_of_file};
pub use path::{beside_the_program, folder_of, free_place, is_same, name_of, whole_path};
pub use place::{is_standard_output, is_stream};
pub use read::{read, read_at_most, read_text, read_text_at_most};
pub use staged::is_temporary;
pub use state::FileState;
pub use write::{
    check_file_writable, check_writable, replace_all_atomically, replace_atomically, write_all_atomically,
    write_atomically, write_beside,
};
