"""Principal geodesics of whole poses of recordings: numbers that stay what they were."""

import numpy as np
import pytest
import quatfilt as qf

RESIDUALS = {
    "02/02_01": [35.11, 25.71, 17.35, 13.94, 11.80],
    "14/14_05": [35.69, 25.56, 16.41, 12.22, 8.77],
}
"""Degrees: `R_1` … `R_5`."""


@pytest.mark.parametrize("clip", RESIDUALS)
def test_of_recordings(data_dir, clip):
    q = qf.read_motion(data_dir / "cmu" / f"{clip}.amc").rotations
    pga = qf.PrincipalGeodesicAnalysis(5, body=True).fit(q)
    np.testing.assert_allclose(np.degrees(pga.residuals_), RESIDUALS[clip], atol=0.006)
    errors = pga.reconstruction_error(q)
    np.testing.assert_allclose(np.sqrt(np.sum(errors**2, axis=1)).mean(), pga.residuals_[-1], rtol=1e-12)
