//! Sensitivities of a mechanism written as vector loops (Shi 2005, corrected).
//!
//! A loop is Σ ± ρ e^{iφ} = 0, each ρ and φ an unknown U, an input V, a length L, a
//! clearance r, a clearance angle a or a constant. With F(U, V, L, r, a) = 0 and x any of
//! the primitives:
//!
//! X = −F_U⁻¹ F_x, X1 = −F_U⁻¹ (Ḟ_x + Ḟ_U X), X2 = −F_U⁻¹ (F̈_x + F̈_U X + 2 Ḟ_U X1),
//!
//! δU = X δx, δU̇ = X1 δx + A δV̇, δÜ = X2 δx + 2 A1 δV̇ + A δV̈, A being X for x = V.

use super::AccuracyError;
use nalgebra::{DMatrix, DVector};

/// What a length or an angle of a term is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoopQuantity {
    /// U: found by closing the loops; it changes with time.
    Unknown(usize),
    /// V: driven; it changes with time.
    Input(usize),
    /// A parameter (a length, a clearance or its angle), constant in time.
    Parameter(usize),
    /// A number without an error.
    Constant(f64),
}

/// sign · ρ e^{i(φ + angle_offset)}.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// +1 along the loop, −1 against it.
    pub sign: f64,
    /// ρ [m].
    pub length: LoopQuantity,
    /// φ [rad].
    pub angle: LoopQuantity,
    /// A constant angle beside φ [rad].
    pub angle_offset: f64,
}

/// A mechanism as loops, with its parameters' values.
#[derive(Clone, Debug)]
pub struct VectorLoops {
    /// The terms of each loop; there are two unknowns for each loop.
    pub loops: Vec<Vec<Term>>,
    /// The number of inputs.
    pub inputs: usize,
    /// The parameters' values [m or rad].
    pub parameters: Vec<f64>,
}

/// The value and the first two time derivatives of some variables.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeDerivatives {
    /// Values.
    pub value: DVector<f64>,
    /// First derivatives.
    pub rate: DVector<f64>,
    /// Second derivatives.
    pub acceleration: DVector<f64>,
}

/// The sensitivities of U, U̇ and Ü, a column for each primitive in the order
/// V, V̇, V̈, parameters.
#[derive(Clone, Debug)]
pub struct Sensitivities {
    /// ∂U.
    pub value: DMatrix<f64>,
    /// ∂U̇.
    pub rate: DMatrix<f64>,
    /// ∂Ü.
    pub acceleration: DMatrix<f64>,
}

/// A complex number a + ib.
type Complex = [f64; 2];

fn complex_product([a, b]: Complex, [c, d]: Complex) -> Complex {
    [a * c - b * d, a * d + b * c]
}

/// The index of a quantity in the vector (U, V, parameters).
#[derive(Clone, Copy)]
enum Slot {
    Variable(usize),
    None,
}

impl VectorLoops {
    fn unknowns(&self) -> usize {
        2 * self.loops.len()
    }

    fn variables(&self) -> usize {
        self.unknowns() + self.inputs + self.parameters.len()
    }

    fn slot(&self, quantity: LoopQuantity) -> Slot {
        match quantity {
            LoopQuantity::Unknown(i) => Slot::Variable(i),
            LoopQuantity::Input(i) => Slot::Variable(self.unknowns() + i),
            LoopQuantity::Parameter(i) => Slot::Variable(self.unknowns() + self.inputs + i),
            LoopQuantity::Constant(_) => Slot::None,
        }
    }

    /// Value, rate and acceleration of a quantity.
    fn at(
        &self,
        quantity: LoopQuantity,
        unknowns: &TimeDerivatives,
        inputs: &TimeDerivatives,
    ) -> [f64; 3] {
        let of = |variables: &TimeDerivatives, i: usize| {
            [
                variables.value[i],
                variables.rate[i],
                variables.acceleration[i],
            ]
        };
        match quantity {
            LoopQuantity::Unknown(i) => of(unknowns, i),
            LoopQuantity::Input(i) => of(inputs, i),
            LoopQuantity::Parameter(i) => [self.parameters[i], 0.0, 0.0],
            LoopQuantity::Constant(value) => [value, 0.0, 0.0],
        }
    }

    /// F: two components for each loop.
    fn closure(&self, unknowns: &TimeDerivatives, inputs: &TimeDerivatives) -> DVector<f64> {
        let mut closure = DVector::zeros(self.unknowns());
        for (row, terms) in self.loops.iter().enumerate() {
            for term in terms {
                let [length, ..] = self.at(term.length, unknowns, inputs);
                let [angle, ..] = self.at(term.angle, unknowns, inputs);
                let angle = angle + term.angle_offset;
                closure[2 * row] += term.sign * length * angle.cos();
                closure[2 * row + 1] += term.sign * length * angle.sin();
            }
        }
        closure
    }

    /// F_x, Ḟ_x and F̈_x over all variables x = (U, V, parameters).
    fn derivatives(
        &self,
        unknowns: &TimeDerivatives,
        inputs: &TimeDerivatives,
    ) -> [DMatrix<f64>; 3] {
        let mut f = [(); 3].map(|()| DMatrix::zeros(self.unknowns(), self.variables()));
        for (row, terms) in self.loops.iter().enumerate() {
            for term in terms {
                let [rho, rho1, rho2] = self.at(term.length, unknowns, inputs);
                let [phi, phi1, phi2] = self.at(term.angle, unknowns, inputs);
                let (sin, cos) = (phi + term.angle_offset).sin_cos();
                let direction = [term.sign * cos, term.sign * sin];
                // ∂/∂ρ = e^{iφ}, then its time derivatives.
                let by_length = [[1.0, 0.0], [0.0, phi1], [-phi1 * phi1, phi2]];
                // ∂/∂φ = iρ e^{iφ}, then its time derivatives.
                let by_angle = [
                    [0.0, rho],
                    [-rho * phi1, rho1],
                    [-2.0 * rho1 * phi1 - rho * phi2, rho2 - rho * phi1 * phi1],
                ];
                for (quantity, factors) in [(term.length, by_length), (term.angle, by_angle)] {
                    let Slot::Variable(column) = self.slot(quantity) else {
                        continue;
                    };
                    for (matrix, factor) in f.iter_mut().zip(factors) {
                        let [x, y] = complex_product(direction, factor);
                        matrix[(2 * row, column)] += x;
                        matrix[(2 * row + 1, column)] += y;
                    }
                }
            }
        }
        f
    }

    /// Closes the loops from a guess of U by Newton's method, and finds U̇ and Ü.
    ///
    /// # Errors
    /// `Unclosed` where Newton's method does not converge from this guess, `Singular`
    /// where F_U has no inverse.
    pub fn solve(
        &self,
        guess: &[f64],
        inputs: &TimeDerivatives,
    ) -> Result<TimeDerivatives, AccuracyError> {
        let n = self.unknowns();
        let mut unknowns = TimeDerivatives {
            value: DVector::from_column_slice(guess),
            rate: DVector::zeros(n),
            acceleration: DVector::zeros(n),
        };
        let scale = 1.0 + self.parameters.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
        let mut closed = false;
        for _ in 0..50 {
            let closure = self.closure(&unknowns, inputs);
            closed = closure.amax() <= 1e-14 * scale;
            if closed {
                break;
            }
            let [f, ..] = self.derivatives(&unknowns, inputs);
            let inverse = invert(&f.columns(0, n).into_owned())?;
            unknowns.value -= inverse * closure;
        }
        if !closed {
            return Err(AccuracyError::Unclosed);
        }
        // U̇ = A V̇, then with the rates known Ü = A V̈ + A1 V̇.
        let [f, ..] = self.derivatives(&unknowns, inputs);
        let inverse = invert(&f.columns(0, n).into_owned())?;
        let a = -&inverse * f.columns(n, self.inputs);
        unknowns.rate = &a * &inputs.rate;
        let [_, f1, _] = self.derivatives(&unknowns, inputs);
        let a1 = -&inverse * (f1.columns(n, self.inputs) + f1.columns(0, n) * &a);
        unknowns.acceleration = a * &inputs.acceleration + a1 * &inputs.rate;
        Ok(unknowns)
    }

    /// The sensitivities of U, U̇ and Ü to every primitive.
    ///
    /// # Errors
    /// `Singular` where F_U has no inverse.
    pub fn sensitivities(
        &self,
        unknowns: &TimeDerivatives,
        inputs: &TimeDerivatives,
    ) -> Result<Sensitivities, AccuracyError> {
        let n = self.unknowns();
        let others = self.inputs + self.parameters.len();
        let [f, f1, f2] = self.derivatives(unknowns, inputs);
        let inverse = invert(&f.columns(0, n).into_owned())?;
        let (fu1, fu2) = (f1.columns(0, n), f2.columns(0, n));
        let x = -&inverse * f.columns(n, others);
        let x1 = -&inverse * (f1.columns(n, others) + fu1 * &x);
        let x2 = -&inverse * (f2.columns(n, others) + fu2 * &x + fu1 * &x1 * 2.0);

        let v = self.inputs;
        let by_inputs = |m: &DMatrix<f64>| m.columns(0, v).into_owned();
        let by_parameters = |m: &DMatrix<f64>| m.columns(v, self.parameters.len()).into_owned();
        let none = DMatrix::zeros(n, v);
        let (a, a1) = (by_inputs(&x), by_inputs(&x1));
        let side_by_side = |blocks: [DMatrix<f64>; 4]| {
            let columns: Vec<_> = blocks
                .iter()
                .flat_map(|block| block.column_iter().map(nalgebra::Matrix::into_owned))
                .collect();
            DMatrix::from_columns(&columns)
        };
        Ok(Sensitivities {
            value: side_by_side([a.clone(), none.clone(), none.clone(), by_parameters(&x)]),
            rate: side_by_side([a1.clone(), a.clone(), none, by_parameters(&x1)]),
            acceleration: side_by_side([by_inputs(&x2), a1 * 2.0, a, by_parameters(&x2)]),
        })
    }
}

fn invert(matrix: &DMatrix<f64>) -> Result<DMatrix<f64>, AccuracyError> {
    matrix.clone().try_inverse().ok_or(AccuracyError::Singular)
}
