//! Jackknife, clusters, Student's t and the paired comparison against SciPy.

use super::*;

/// Of `../reference.py`.
mod by_scipy {
    #![allow(
        clippy::unreadable_literal,
        clippy::excessive_precision,
        reason = "as printed"
    )]
    pub(super) const LEFT_OUT: [f64; 6] = [
        0.10821944007713016,
        0.07289739841414068,
        0.06952982907314739,
        0.2226560629231288,
        0.11327982835647069,
        0.06213475601626962,
    ];
    pub(super) const MOVES: [f64; 18] = [
        0.029425742346915744,
        0.015617691726350937,
        -0.010191511879795662,
        -0.029463947560426466,
        0.026935497167553283,
        0.009239421368367834,
        -0.01745144884913366,
        0.00011062003780039093,
        0.004675187055528981,
        0.020117698967041037,
        -0.039050418157910084,
        0.004100746791263488,
        -0.0004419053137713061,
        0.0014267843734606447,
        -0.006353629274001475,
        -8.172645486427379e-05,
        -0.002747800106150931,
        -0.004247218777313367,
    ];
    pub(super) const COVARIANCE: [f64; 9] = [
        0.0020356143868765116,
        -0.0009356740776899178,
        -0.00047257085065638844,
        -0.0009356740776899178,
        0.0020859091551165554,
        -5.520995969064751e-05,
        -0.00047257085065638844,
        -5.520995969064751e-05,
        0.00023752458302521266,
    ];
    pub(super) const BY_GROUP: [f64; 9] = [
        0.00133778989901932,
        -0.0003283432226568042,
        -9.341584982556872e-05,
        -0.0003283432226568042,
        0.0010700661995887446,
        4.697519247715877e-05,
        -9.341584982556872e-05,
        4.697519247715877e-05,
        3.890382883965188e-05,
    ];
    pub(super) const COUNTING: [f64; 2] = [6.0, 4.509259140926973];
    pub(super) const PAIRED: [f64; 2] = [0.6375880922568226, 3.2364299729829384];
    pub(super) const STUDENT: [f64; 8] = [
        4.302652729749462,
        3.3921483831737507,
        3.1824463052837078,
        2.501858617589239,
        2.200985160091639,
        2.0930240544083087,
        2.0002978220142604,
        1.9659123432294627,
    ];
}

/// Asserts that all of these numbers agree to 1e-9.
fn agree<'a>(ours: impl IntoIterator<Item = &'a f64>, theirs: &[f64]) {
    let ours: Vec<f64> = ours.into_iter().copied().collect();
    assert_eq!(ours.len(), theirs.len());
    for (a, b) in ours.iter().zip(theirs) {
        assert!(
            (a - b).abs() <= 1e-9 * b.abs().max(1e-3),
            "{ours:?}\n{theirs:?}"
        );
    }
}

#[test]
fn scipy_agrees_on_a_linear_model() {
    let i = |i: usize| i as f64;
    let columns = DMatrix::from_fn(30, 3, |row, column| match column {
        0 => 1.0,
        1 => (0.7 * i(row)).sin(),
        _ => 0.1 * i(row) + (1.9 * i(row)).cos(),
    });
    let y = DVector::from_fn(30, |row, _| {
        2.0 - 0.5 * columns[(row, 1)]
            + 0.3 * columns[(row, 2)]
            + 0.2 * (5.3 * i(row) * i(row)).sin()
    });
    let normal = columns.tr_mul(&columns).cholesky().unwrap();
    let residual = &y - &columns * normal.solve(&columns.tr_mul(&y));
    let linear = Linear {
        columns: &columns,
        residual: &residual,
        prior: &DMatrix::from_diagonal(&DVector::from_vec(vec![0.0, 0.4, 2.5])),
        blocks: &[0..4, 4..9, 9..15, 15..20, 20..26, 26..30],
    };
    let moves = linear.without_each().unwrap();
    agree(moves.iter().flat_map(|by| by.iter()), &by_scipy::MOVES);
    agree(&of_moves(&moves), &by_scipy::COVARIANCE);
    let groups: Vec<usize> = (0..30).map(|i| i * 7 % 4).collect();
    let mut by_group = DMatrix::zeros(3, 3);
    for by in linear.by_group(&groups).unwrap() {
        by_group += &by * by.transpose();
    }
    agree(&by_group, &by_scipy::BY_GROUP);
    let first: Vec<f64> = moves.iter().map(|by| by[0]).collect();
    let few = [0.1, -0.02, 0.03, 1.0, 0.5, -0.05];
    agree(&[counting(&first), counting(&few)], &by_scipy::COUNTING);
    let other = [0.31, 0.22, 0.47, 0.18, 0.36, 0.25];
    agree(
        &<[f64; 2]>::from(gain(&by_scipy::LEFT_OUT, &other)),
        &by_scipy::PAIRED,
    );
}

#[test]
fn scipy_agrees_on_the_quantiles_of_student() {
    let freedom = [2.0, 2.7, 3.0, 5.5, 11.0, 19.0, 60.0, 400.0];
    agree(&freedom.map(student), &by_scipy::STUDENT);
}

#[test]
fn a_stroke_is_scored_by_a_fit_without_it() {
    // Six strokes of a limb; in one of them a weight is 2 N·m greater.
    let time_s: Vec<f64> = (0..6000).map(|i| f64::from(i) * 5e-3).collect();
    let angle = |t: &f64| 0.9 - 0.8 * (std::f64::consts::TAU * 0.1 * t).cos();
    let angle_rad: Vec<f64> = time_s.iter().map(angle).collect();
    let more = |i: usize| if (2000..3000).contains(&i) { 2.0 } else { 0.0 };
    let pairs = angle_rad.iter().enumerate();
    let torque_nm = pairs
        .map(|(i, angle)| (6.0 + more(i)) * angle.cos())
        .collect();
    let motion = Motion::of(&crate::knee::Examination {
        time_s,
        angle_rad,
        torque_nm,
        released_kg_m2: None,
    })
    .unwrap();
    let (_, begins) = crate::knee::stroke::strokes(&motion).unwrap();
    let blocks = crate::knee::stroke::blocks(&begins, motion.len());
    let is_cancelled = std::sync::atomic::AtomicBool::new(false);
    let symptom = crate::knee::Symptom::Healthy;
    let problem = Problem::new(&motion, &blocks, symptom, false, &is_cancelled);
    let point = problem.best().unwrap();
    let jackknife = Jackknife::of(&problem, &point).unwrap();
    let odd = blocks
        .iter()
        .position(|block| block.contains(&2500))
        .unwrap();
    let whole: f64 = (2000..3000)
        .map(|i| (2.0 * motion.angle_rad[i].cos()).powi(2))
        .sum();
    let left_out = jackknife.left_out[odd];
    assert!((left_out / whole - 1.0).abs() < 0.15, "{left_out} {whole}");
}
