"""The figures of exact principal geodesic analysis: what is computed, and what the page says of it."""

import json

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation import (
    pga_figs,
    pga_figs_page,
    pga_figs_picture,
    pga_of_motion,
    pga_of_motion_picture,
)
from quatfilt.evaluation import pga_figs_samples as samples
from quatfilt.evaluation._written import write
from quatfilt.evaluation.pga_figs_descent import descend, distances, residual, start
from quatfilt.evaluation.synthetic import walk


@pytest.fixture(scope="module", name="figures")
def figures_of_the_walk():
    return pga_figs.run(None, seeds=2)


def test_one_geodesic_is_found_without_a_step(figures):
    one = figures.low[0]
    assert one.started < 1e-12
    assert one.residuals[0] < 1e-9
    assert one.printed[0][0] > 0.1  # from a random start it takes steps
    assert one.printed[0][-1] < 1e-9
    assert one.exact[0][-1] < 1e-9


def test_products_of_two_geodesics_leave_nothing_after_two(figures):
    products, plane = figures.low[1:]
    assert products.residuals[1] < 1e-8
    assert products.residuals[0] > 0.1
    assert plane.residuals[1] > 0.01


def test_the_descents_are_never_below_the_exact_analysis(figures):
    for one in figures.low:
        for curve in (one.printed[0], one.exact[0]):
            assert curve[-1] >= one.residuals[0] - 1e-9
        assert (np.diff(one.exact[0]) <= 0).all()


def test_the_gaussian_has_its_eigenvectors_and_needs_more_than_five(figures):
    gaussian = figures.gaussian
    assert gaussian.off[:, 0].max() < 10
    assert (np.diff(gaussian.residuals, axis=1) < 0).all()
    assert gaussian.residuals[:, -1].min() > 1e-6
    assert len(gaussian.descents) == pga_figs.COMPONENTS


def test_samples_have_the_density_of_the_paper():
    q = np.concatenate([samples.gaussian(np.random.default_rng(seed))[0] for seed in range(20)])
    assert q.shape == (20 * samples.SAMPLES, 4)
    spread = [
        qf.log(samples.gaussian(np.random.default_rng(seed))[0])
        @ samples.gaussian(np.random.default_rng(seed))[1].T
        for seed in range(20)
    ]
    # Weighted by r²/sin² r the shells of S³ become those of space, and the covariance Γ⁻¹.
    v = np.concatenate(spread)
    weights = 1 / np.sinc(np.linalg.norm(v, axis=1) / np.pi) ** 2
    variances = (weights @ v**2) / weights.sum()
    np.testing.assert_allclose(variances * samples.CONCENTRATIONS, 1, rtol=0.05)


def test_a_descent_ends_where_the_printed_gradient_vanishes():
    rng = np.random.default_rng(4)
    q = qf.exp(rng.normal(0, [0.5, 0.2, 0.1], (300, 3)))
    v, curve = descend(q, start(q), printed=True)
    moved = [v + 1e-4 * np.eye(3)[axis] for axis in range(3)]
    least = np.cos(distances(q, v)).mean()
    assert all(np.cos(distances(q, m / np.linalg.norm(m))).mean() < least + 1e-10 for m in moved)
    assert curve[-1] == pytest.approx(distances(q, v).mean())


def test_what_is_left_has_no_part_along_the_geodesic():
    rng = np.random.default_rng(5)
    q = qf.exp(rng.normal(0, 0.3, (50, 3)))
    v = np.array([0.0, 0.6, 0.8])
    left = residual(q, v)
    np.testing.assert_allclose(left[:, 1:] @ v, 0, atol=1e-12)
    np.testing.assert_allclose(qf.geodesic_distance(left, [1.0, 0, 0, 0]), 2 * distances(q, v), atol=1e-12)


def test_three_tangent_axes_leave_nothing():
    rng = np.random.default_rng(6)
    left = pga_figs.tangent_residuals(qf.exp(rng.normal(0, 0.4, (80, 3))), 4)
    assert left[0] > left[1] > 1e-3
    assert max(left[2:]) < 1e-9


def test_page_numbers_and_picture(figures, tmp_path):
    run = pga_figs_page.Run("1.2.3", "a command")
    numbers = pga_figs.as_dict(figures, vars(run))
    written, trouble = write(
        tmp_path,
        pga_figs_page.STEM,
        page=pga_figs_page.markdown(figures, run),
        numbers=numbers,
        draw=lambda path: pga_figs_picture.draw(figures, path),
    )
    assert trouble == ""
    assert [path.suffix for path in written] == [".md", ".json", ".png"]
    page = written[0].read_text(encoding="utf-8")
    assert "Written by `a command`, version 1.2.3." in page
    kept = json.loads(written[1].read_text(encoding="utf-8"))
    assert f"{kept['root']['residuals'][1]:.4f}" in page
    assert f"{np.median(kept['joints'][0]['residuals'][0]):.4f}" in page


def test_a_joint_that_turns_around_says_so_and_the_others_are_analysed(tmp_path):
    motion = walk(seconds=2)
    q = motion.rotations.copy()
    turn = np.linspace(0, 2 * np.pi, len(q), endpoint=False)
    q[:, 3] = qf.exp(0.5 * turn[:, None] * [0.0, 1.0, 0.0])
    spun = motion.replace(rotations=q)
    found = pga_of_motion.analyse(spun, range(6), 3, "geodesic")
    assert [bool(joint.trouble) for joint in found] == [place == 3 for place in range(6)]
    assert found[3].trouble.startswith("the mean is not unique")
    pga_of_motion_picture.draw(spun, found, tmp_path / "pga.png")
    assert (tmp_path / "pga.png").read_bytes().startswith(b"\x89PNG")
