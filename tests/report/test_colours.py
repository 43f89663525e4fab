"""Colours can be told apart, also by readers who do not see all of them."""

from itertools import combinations

import numpy as np
import pytest

from ompl_risk.report.style import COLOURS, RISKIEST, SAFEST

# Machado, Oliveira and Fernandes, A Physiologically-based Model for Simulation of Color Vision
# Deficiency, 2009, severity 1.
VISION = {
    "full": np.eye(3),
    "no green": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
                 [-0.011820, 0.042940, 0.968881]],
    "no red": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
               [-0.003882, -0.048116, 1.051998]],
    "no blue": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
                [0.004733, 0.691367, 0.303900]],
}  # fmt: skip
TO_XYZ = np.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750],
                   [0.0193339, 0.1191920, 0.9503041]])  # fmt: skip


def lab(colour, vision):
    """CIE L*a*b* of a colour as it is seen."""
    code = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    light = np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)
    xyz = TO_XYZ @ np.clip(np.array(vision) @ light, 0.0, 1.0) / TO_XYZ.sum(axis=1)
    x, y, z = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def test_the_scale_has_its_known_ends():
    np.testing.assert_allclose(lab("#FFFFFF", np.eye(3)), [100.0, 0.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(lab("#000000", np.eye(3)), [0.0, 0.0, 0.0], atol=1e-3)
    np.testing.assert_allclose(lab("#FF0000", np.eye(3)), [53.24, 80.09, 67.20], atol=0.02)


@pytest.mark.parametrize("vision", VISION)
def test_lines_can_be_told_apart(vision):
    for one, other in combinations(COLOURS, 2):
        gap = np.linalg.norm(lab(one, VISION[vision]) - lab(other, VISION[vision]))
        assert gap > 15.0, (one, other)


@pytest.mark.parametrize("vision", VISION)
def test_backgrounds_can_be_told_apart_and_text_on_them_be_read(vision):
    safest, riskiest, white = (lab(c, VISION[vision]) for c in (SAFEST, RISKIEST, "#FFFFFF"))
    assert np.linalg.norm(safest - riskiest) > 20.0
    for background in (safest, riskiest):
        assert np.linalg.norm(background - white) > 8.0
        assert background[0] > 80.0
