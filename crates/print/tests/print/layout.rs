//! Templates spread over sheets.

use scaleproof_print::media::Media;
use scaleproof_print::paper::{Orientation, Paper, Stock};
use scaleproof_print::template::{LayoutRequest, layout};

pub fn request(size_mm: (f64, f64)) -> LayoutRequest {
    LayoutRequest {
        size_mm,
        media: Media::new(Paper::A4),
        orientation: Orientation::Auto,
        overlap_mm: 8.0,
        bleed_mm: 2.0,
    }
}

#[test]
fn the_fewest_sheets_win() {
    let wide = layout(&request((256.0, 156.0))).unwrap();
    assert_eq!((wide.sheets.len(), wide.frame.page), (1, Paper::A4.landscape()));
    let tall = layout(&request((156.0, 236.0))).unwrap();
    assert_eq!((tall.sheets.len(), tall.frame.page), (1, Paper::A4));
}

#[test]
fn a_template_made_to_measure_needs_one_sheet() {
    let usable = layout(&request((10.0, 10.0))).unwrap().frame.usable;
    let size_mm = (usable.width_mm() - 4.0, usable.height_mm() - 4.0);
    assert_eq!(layout(&request(size_mm)).unwrap().sheets.len(), 1);
}

#[test]
fn a_roll_is_used_the_way_that_wastes_less() {
    let media = Media::new(Stock::Roll { width_mm: 610.0 });
    let of = |size_mm| {
        let made = layout(&LayoutRequest {
            media,
            ..request(size_mm)
        })
        .unwrap();
        (made.sheets.len(), made.frame.page.width_mm, made.frame.page.height_mm)
    };
    // 1800 + two bleeds + what the page takes (19.5) + two margins.
    assert_eq!(of((1800.0, 500.0)), (1, 1834.0, 610.0));
    assert_eq!(of((500.0, 1800.0)), (1, 610.0, 1847.0));
    assert_eq!(of((30.0, 30.0)), (1, 610.0, 143.0));
    assert_eq!(of((560.0, 9000.0)).0, 2);
}
