//! Printers and their files.

use scaleproof_print::printer::{NOMINAL_MM, Printer, PrinterFile};

#[test]
fn a_printer_file_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("printer.toml");
    let printer = Printer::measured(99.3, 99.8).unwrap();
    let file = PrinterFile { printer, colours: None };
    std::fs::write(&path, file.to_toml().unwrap()).unwrap();
    assert_eq!(PrinterFile::load(&path), Ok(file));
}

#[test]
fn a_corrected_page_measured_again_is_corrected_further() {
    let first = Printer::measured(98.0, 100.0).unwrap();
    let again = Printer::measured(100.5, 100.0).unwrap();
    let both = first.remeasured(&again).unwrap();
    let (x, y) = both.factors();
    assert!((NOMINAL_MM / x - 98.49).abs() < 1e-9 && NOMINAL_MM / y == 100.0);
}

#[test]
fn a_scaled_print_is_no_printer() {
    for (x, y) in [(94.9, 100.0), (100.0, 105.1), (f64::NAN, 100.0), (0.0, 100.0)] {
        assert!(Printer::measured(x, y).is_err(), "{x} {y}");
    }
}
