"""Six views of a ChArUco board in the layout before OpenCV 4.6, drawn by OpenCV: tests/data/cases/legacy_board.

pip install numpy opencv-python-headless
"""
from pathlib import Path

import cv2
import numpy as np

HERE = Path(__file__).parent / "cases/legacy_board"
SQUARE_MM, PX_PER_MM, F = 22.0, 6.0, 700.0
board = cv2.aruco.CharucoBoard((8, 6), SQUARE_MM, 16.0, cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_5X5_100))
board.setLegacyPattern(True)
size = (int(8 * SQUARE_MM * PX_PER_MM), int(6 * SQUARE_MM * PX_PER_MM))
drawn = board.generateImage(size)
K = np.array([[F, 0, 319.5], [0, F, 239.5], [0, 0, 1]])
# Pixel centres of the drawing in mm on the board, whose middle is the origin.
to_mm = np.array([[1 / PX_PER_MM, 0, 0.5 / PX_PER_MM - 88], [0, 1 / PX_PER_MM, 0.5 / PX_PER_MM - 66], [0, 0, 1]])
for number, turn in enumerate([(0.5, 0, 0), (-0.5, 0, 0.2), (0, 0.5, 0), (0, -0.5, -0.2), (0.35, 0.35, 0), (0.3, -0.4, 0.3)]):
    R = cv2.Rodrigues(np.array(turn, float))[0]
    t = np.array([8.0 * (number - 2.5), 5.0 * (number % 3 - 1), 280.0 + 10 * number])
    H = K @ np.c_[R[:, 0], R[:, 1], t] @ to_mm
    # Drawn four times as large and reduced: a camera's pixels take means.
    S = np.array([[4, 0, 1.5], [0, 4, 1.5], [0, 0, 1.0]])
    large = cv2.warpPerspective(drawn, S @ H, (2560, 1920), flags=cv2.INTER_AREA, borderValue=255)
    photo = cv2.resize(large, (640, 480), interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(HERE / f"{number}.jpg"), photo, [cv2.IMWRITE_JPEG_QUALITY, 80])
