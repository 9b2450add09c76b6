//! Definitions of boards and their files.

use scaleproof_print::board::{BoardKind, BoardRequest, Definition, definition};
use scaleproof_print::media::Media;
use scaleproof_print::paper::Paper;

#[test]
fn the_file_comes_back_as_it_was() {
    let request = BoardRequest {
        kind: BoardKind::Aprilgrid,
        squares: (6, 5),
        square_mm: 26.0,
        marker_mm: None,
        dictionary: None,
        media: Media::new(Paper::A4),
    };
    for kind in [BoardKind::Aprilgrid, BoardKind::Charuco, BoardKind::Chessboard] {
        let definition = definition(&BoardRequest {
            kind,
            ..request.clone()
        })
        .unwrap();
        let text = definition.to_toml().unwrap();
        assert_eq!(toml::from_str::<Definition>(&text).unwrap(), definition, "{text}");
    }
}
