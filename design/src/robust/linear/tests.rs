//! The sums over a block are those of nalgebra's products.

use super::super::Block;
use super::Linear;
use crate::Noise;
use nalgebra::{DMatrix, DVector};

#[test]
fn fits_and_predictions_are_those_of_nalgebras_products_to_the_last_bit() {
    const UNKNOWNS: usize = 9;
    let mut noise = Noise::new(1);
    let blocks: Vec<Block> = (0..20)
        .map(|at| Block {
            first: at + at.min(10),
            size: if at < 10 { 2 } else { 1 },
            kind: usize::from(at >= 10),
        })
        .collect();
    // Each unknown is seen by two rows of three.
    let jacobian = DMatrix::from_fn(30, UNKNOWNS, |row, column| {
        let derivative = noise.normal();
        if (row + column) % 3 == 0 {
            0.0
        } else {
            derivative
        }
    });
    let residuals = DVector::from_fn(30, |_, _| noise.normal());
    let linear = Linear::new((residuals, jacobian), &blocks);
    let kept: Vec<bool> = (0..20).map(|at| at % 7 != 3).collect();
    let scales = [1.5, 0.7_f64];

    let mut normal = DMatrix::zeros(UNKNOWNS, UNKNOWNS);
    let mut right = DVector::zeros(UNKNOWNS);
    for (block, _) in blocks.iter().zip(&kept).filter(|(_, kept)| **kept) {
        let rows = linear.jacobian.rows(block.first, block.size);
        let weight: f64 = scales[block.kind].powi(-2);
        normal.gemm_tr(weight, &rows, &rows, 1.0);
        right.gemv_tr(
            -weight,
            &rows,
            &linear.residuals.rows(block.first, block.size),
            1.0,
        );
    }
    let ridge = 1e-12 * normal.trace();
    for i in 0..UNKNOWNS {
        normal[(i, i)] += ridge;
    }
    let factor = normal.cholesky().unwrap();
    let fit = linear.fit(&kept, &scales).unwrap();
    assert_eq!(fit.inverse, factor.inverse());
    let expected = &linear.residuals + &linear.jacobian * factor.solve(&right);
    assert_eq!(fit.residuals, expected);

    for (at, block) in blocks.iter().enumerate() {
        let rows = linear.jacobian.rows(block.first, block.size);
        let hat = rows * &fit.inverse * rows.transpose() * scales[block.kind].powi(-2);
        let predicted = linear.predicted(&fit, &kept, &scales, at);
        assert_eq!(
            predicted.redundancy,
            block.size as f64 - hat.trace(),
            "{at}"
        );
    }
}
