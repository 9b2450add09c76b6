//! Why a tethered camera gives no photo, from what gphoto2 says.

/// Why a tethered camera gives no photo, as a sentence to act on.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TetherError {
    #[error(
        "tethered cameras are used through the program gphoto2, and this system has none: install it (Debian: apt install gphoto2)"
    )]
    NoProgram,
    #[error("gphoto2 could not be started: {0}")]
    NotStarted(String),
    #[error("no camera answers gphoto2: plug it in, switch it on, and set its USB connection to PTP or PC remote")]
    NoCamera,
    #[error("several cameras answer gphoto2 ({0}): name one with gphoto2:PORT, see `scaleproof capture list-cameras`")]
    Several(String),
    #[error("the {0} takes no photos for a computer: copy its photos into a folder and watch that (watch:DIR)")]
    NoCapture(String),
    #[error("another program uses the camera: close it, or unmount the camera in the file manager")]
    Busy,
    #[error("the camera is at something else: wait until its lamp is out, and leave its menus")]
    Working,
    #[error("the camera's card is full: empty it, or put in another")]
    CardFull,
    #[error("the camera found no focus and took no photo: focus by hand (MF) and leave it")]
    NoFocus,
    #[error("the camera broke off: see to its cable and its battery")]
    Unplugged,
    #[error("the camera sent no photo within {seconds} s: see whether it waits for something")]
    TooSlow { seconds: u64 },
    #[error("the camera sent {0}, and no JPEG: set its image quality to JPEG, or to RAW and JPEG")]
    NoJpeg(String),
    #[error("the camera took no photo{0}")]
    NoPhoto(String),
    /// A folder for the photos on their way.
    #[error("there is no room for the photo on its way: {0}")]
    NoRoom(String),
}

/// Words of libgphoto2 and of its drivers, in small letters, by what they mean; the first that is met counts. `gphoto2-port-result.c`,
/// `gphoto2-result.c`, and `camlibs/ptp2/ptp.c` of libgphoto2 2.5.
const MEANINGS: [(TetherError, &[&str]); 7] = [
    (
        TetherError::Busy,
        &["could not claim", "could not lock", "resource busy"],
    ),
    (
        TetherError::CardFull,
        &[
            "store full",
            "not enough free space",
            "no space",
            "card full",
            "memory card is full",
        ],
    ),
    (TetherError::NoFocus, &["focus"]),
    (TetherError::Working, &["device busy", "i/o in progress", "camera busy"]),
    (
        TetherError::NoCamera,
        &[
            "no camera found",
            "could not find the requested device",
            "unknown model",
            "error: -105",
            "could not detect any camera",
        ],
    ),
    (
        TetherError::Unplugged,
        &[
            "i/o problem",
            "no such device",
            "timeout",
            "error reading from the port",
            "error writing to the port",
        ],
    ),
    (
        TetherError::NoCamera,
        // Without a camera gphoto2 takes its driver for folders, which can do nothing.
        &["this camera can not capture"],
    ),
];

impl TetherError {
    /// What gphoto2 means by what it wrote on standard error, in English.
    pub fn understood(said: &str) -> TetherError {
        let small = said.to_lowercase();
        let known = MEANINGS
            .iter()
            .find(|(_, words)| words.iter().any(|word| small.contains(word)));
        if let Some((meaning, _)) = known {
            return meaning.clone();
        }
        let lines: Vec<&str> = said.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
        // Below a heading stands the driver's own sentence.
        let below = lines.iter().position(|line| line.starts_with("*** Error ***"));
        let sentence = below
            .and_then(|at| lines.get(at + 1))
            .or_else(|| lines.iter().find(|line| line.starts_with("ERROR: ")));
        let sentence = sentence.map(|line| line.trim_start_matches("ERROR: ").trim_end_matches('.'));
        TetherError::NoPhoto(sentence.map_or(String::new(), |sentence| format!(": {sentence}")))
    }
}
