//! Scale of a printer: measured once on paper, kept in `printer.toml`, and corrected on every later sheet. The file may also contain the printer's
//! colours, which do not change any sheet.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::ruler;
use super::sheet::{Fill, Line, Mark, RectMm, Sheet, Stamp, Text};
use scaleproof_core::files;
use scaleproof_core::geometry::Point2;
use scaleproof_core::geometry::length::shown;
use scaleproof_plot::lettering::number;
use scaleproof_surface::pattern::printed::PrintedColours;

/// Nominal length of the rulers of every sheet.
pub const NOMINAL_MM: f64 = ruler::LENGTH_MM;
/// Maximum relative error of a printer; a larger one is a print setting, to be undone there.
pub const MOST_OFF: f64 = 0.05;

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PrinterError {
    #[error(
        "100 mm that measure {measured_mm} mm along {axis} are more than 5 % off: the print was scaled; print the check page again \
         at 100 % (no fit to page) and measure both rulers in mm",
        measured_mm = shown(*measured_mm)
    )]
    Implausible { axis: &'static str, measured_mm: f64 },
    #[error("{path} cannot be used ({reason}); make it with `scaleproof print verify`, its colours with `scaleproof colour read`", path = path.display())]
    BadFile { path: PathBuf, reason: String },
    #[error("the printer file could not be put together: {reason}")]
    Encoding { reason: String },
}

/// Measured length of 100 mm on paper. x runs along the short side of cut paper and across a roll, y along the other side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Printer {
    x_mm: f64,
    y_mm: f64,
}

/// Lengths in the file `printer.toml`. The factors repeat the lengths' content, for people and other programs.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Lengths {
    nominal_mm: f64,
    measured_x_mm: f64,
    measured_y_mm: f64,
    correction_x: f64,
    correction_y: f64,
}

/// Content of a printer file. A file written only by `colour read` has no lengths.
#[derive(Debug, Clone, PartialEq)]
pub struct PrinterFile {
    pub printer: Printer,
    pub colours: Option<PrintedColours>,
}

impl Printer {
    /// Unmeasured printer, assumed exact.
    pub const EXACT: Self = Self {
        x_mm: NOMINAL_MM,
        y_mm: NOMINAL_MM,
    };

    /// Creates the printer with these measured lengths of the two 100 mm rulers.
    ///
    /// # Errors
    /// A length more than `MOST_OFF` from 100 mm.
    pub fn measured(x_mm: f64, y_mm: f64) -> Result<Self, PrinterError> {
        for (axis, measured_mm) in [("x", x_mm), ("y", y_mm)] {
            // False for NaN too.
            let plausible = (measured_mm / NOMINAL_MM - 1.0).abs() <= MOST_OFF;
            if !plausible {
                return Err(PrinterError::Implausible { axis, measured_mm });
            }
        }
        Ok(Self { x_mm, y_mm })
    }

    /// Returns the printer by two measurements: without a correction (`self`), and of a page printed with that correction (`again`).
    ///
    /// # Errors
    /// As for [`Printer::measured`].
    pub fn remeasured(&self, again: &Self) -> Result<Self, PrinterError> {
        Self::measured(self.x_mm * again.x_mm / NOMINAL_MM, self.y_mm * again.y_mm / NOMINAL_MM)
    }

    /// Returns drawn length over true length, along x and y.
    pub fn factors(&self) -> (f64, f64) {
        (NOMINAL_MM / self.x_mm, NOMINAL_MM / self.y_mm)
    }

    /// Returns the command for a page whose rulers are to be measured. A corrected page needs its correction in the command, which would otherwise be
    /// lost.
    pub fn verify_command(&self) -> String {
        let known = if *self == Self::EXACT {
            ""
        } else {
            " --printer printer.toml"
        };
        format!("scaleproof print verify --x-mm … --y-mm …{known} -o printer.toml")
    }

    /// Returns the correction as a clause for the caption of a sheet.
    pub fn caption(&self) -> String {
        if *self == Self::EXACT {
            return "no printer correction".into();
        }
        let (x, y) = self.factors();
        let measured = format!("{} / {} mm", number(self.x_mm), number(self.y_mm));
        format!("printer correction x ×{x:.4} y ×{y:.4} (100 mm measured {measured})")
    }

    /// Reads a `printer.toml`.
    ///
    /// # Errors
    /// A file that is missing, is no printer file, contradicts itself or describes an implausible printer.
    pub fn load(path: &Path) -> Result<Self, PrinterError> {
        Ok(PrinterFile::load(path)?.printer)
    }

    fn from_lengths(lengths: &Lengths) -> Result<Self, String> {
        if lengths.nominal_mm != NOMINAL_MM {
            return Err(format!("nominal_mm must be {NOMINAL_MM}"));
        }
        let printer = Self::measured(lengths.measured_x_mm, lengths.measured_y_mm).map_err(|e| e.to_string())?;
        let (x, y) = printer.factors();
        // The file has six decimals.
        let agrees = (x - lengths.correction_x).abs() < 1e-5 && (y - lengths.correction_y).abs() < 1e-5;
        if !agrees {
            return Err("its correction factors are not 100 over its measured lengths".into());
        }
        Ok(printer)
    }

    fn lengths(&self) -> Lengths {
        let rounded = |value: f64| (value * 1e6).round() / 1e6;
        let (x, y) = self.factors();
        Lengths {
            nominal_mm: NOMINAL_MM,
            measured_x_mm: rounded(self.x_mm),
            measured_y_mm: rounded(self.y_mm),
            correction_x: rounded(x),
            correction_y: rounded(y),
        }
    }
}

impl PrinterFile {
    /// Reads a `printer.toml`.
    pub fn load(path: &Path) -> Result<Self, PrinterError> {
        let text = files::read_text(path).map_err(|e| e.to_string());
        text.and_then(|text| Self::parse(&text))
            .map_err(|reason| PrinterError::BadFile {
                path: path.to_owned(),
                reason,
            })
    }

    fn parse(text: &str) -> Result<Self, String> {
        // The parser's message may have several lines; the error text has one.
        let plain = |e: toml::de::Error| e.message().replace('\n', " ");
        let mut table: toml::Table = toml::from_str(text).map_err(plain)?;
        let colours: Option<PrintedColours> = table
            .remove("colour")
            .map(toml::Value::try_into)
            .transpose()
            .map_err(plain)?;
        if let Some(colours) = &colours {
            colours.check().map_err(|e| e.to_string())?;
        }
        // A file of colours alone has no lengths; the printer is then assumed exact.
        let printer = if table.is_empty() && colours.is_some() {
            Printer::EXACT
        } else {
            Printer::from_lengths(&table.try_into().map_err(plain)?)?
        };
        Ok(Self { printer, colours })
    }

    /// Returns the content of a `printer.toml`.
    ///
    /// # Errors
    /// Only if the encoder fails.
    pub fn to_toml(&self) -> Result<String, PrinterError> {
        let failed = |e: toml::ser::Error| PrinterError::Encoding { reason: e.to_string() };
        let mut parts = Vec::new();
        if self.printer != Printer::EXACT || self.colours.is_none() {
            let lengths = toml::to_string(&self.printer.lengths()).map_err(failed)?;
            parts.push(format!(
                "# What this printer makes of 100 mm: x along the short side of the paper (across a roll), y along the other.\n{lengths}"
            ));
        }
        if let Some(colours) = &self.colours {
            let colours = colours.to_toml().map_err(failed)?;
            parts.push(format!(
                "# What this printer makes of colours, relative to the paper's white, by `scaleproof colour read`.\n{colours}"
            ));
        }
        Ok(parts.join("\n"))
    }
}

/// Scales sheets so that a printer which divides lengths by `stretch` prints them at true size. The page keeps its size and its centre. Lines keep
/// their width.
pub fn corrected(mut sheets: Vec<Sheet>, stretch: (f64, f64)) -> Vec<Sheet> {
    if stretch == (1.0, 1.0) {
        return sheets;
    }
    let mut stamps = Vec::new();
    for sheet in &mut sheets {
        let centre = [0.5 * sheet.width_mm, 0.5 * sheet.height_mm];
        let page = PageStretch {
            factors: stretch,
            centre,
        };
        sheet.trim = page.area(sheet.trim);
        sheet.bleed = page.area(sheet.bleed);
        page.apply(&mut sheet.marks, &mut stamps);
    }
    sheets
}

/// Applies [`corrected`] to one sheet that shares no stamps with others.
pub fn corrected_one(sheet: Sheet, stretch: (f64, f64)) -> Sheet {
    corrected(vec![sheet], stretch).swap_remove(0)
}

/// Stamp before and after scaling.
type StretchedStamp = (Arc<Stamp>, Arc<Stamp>);

struct PageStretch {
    factors: (f64, f64),
    centre: Point2,
}

impl PageStretch {
    fn point(&self, p: Point2) -> Point2 {
        let c = self.centre;
        [
            c[0] + (p[0] - c[0]) * self.factors.0,
            c[1] + (p[1] - c[1]) * self.factors.1,
        ]
    }

    fn points<'a>(&self, points: impl IntoIterator<Item = &'a mut Point2>) {
        points.into_iter().for_each(|point| *point = self.point(*point));
    }

    fn area(&self, r: RectMm) -> RectMm {
        let low = self.point([r.left_mm, r.bottom_mm]);
        let high = self.point([r.right_mm, r.top_mm]);
        RectMm::new(low[0], low[1], high[0], high[1])
    }

    fn apply(&self, marks: &mut [Mark], stamps: &mut Vec<StretchedStamp>) {
        for mark in marks {
            match mark {
                Mark::Fill(Fill { area, .. }) | Mark::Image { area, .. } => *area = self.area(*area),
                Mark::Line(Line { from, to, .. }) => self.points([from, to]),
                Mark::Text(Text { at, size_mm, .. }) => {
                    self.points([at]);
                    *size_mm *= self.factors.0;
                }
                Mark::Area { outlines, .. } | Mark::Cut { outlines, .. } => self.points(outlines.iter_mut().flatten()),
                Mark::Stamped { stamp, at, clip } => {
                    *stamp = self.stamp(stamp, stamps);
                    self.points(at);
                    *clip = self.area(*clip);
                }
                Mark::Clipped { to, marks } => {
                    self.points(to.iter_mut().flatten());
                    self.apply(marks, stamps);
                }
            }
        }
    }

    /// Scales each stamp once, so that the sheets go on sharing it.
    fn stamp(&self, stamp: &Arc<Stamp>, known: &mut Vec<StretchedStamp>) -> Arc<Stamp> {
        if let Some((_, done)) = known.iter().find(|(old, _)| Arc::ptr_eq(old, stamp)) {
            return Arc::clone(done);
        }
        // A stamp's frame has its own origin, already moved by `at`.
        let own = Self {
            factors: self.factors,
            centre: [0.0, 0.0],
        };
        let mut done = Stamp::clone(stamp);
        done.bounds = own.area(done.bounds);
        done.fills.iter_mut().for_each(|fill| fill.area = own.area(fill.area));
        let done = Arc::new(done);
        known.push((Arc::clone(stamp), Arc::clone(&done)));
        done
    }
}
