//! Formulas, evaluated with their derivatives.

use std::str::FromStr;

use exmex::{
    BinOp, Express, FlatEx, MakeOperators, MatchLiteral, Operator, literal_matcher_from_pattern, ops_factory,
};

use super::StudyError;
use crate::limit::Taylor;

/// A Taylor polynomial as the parser wants numbers: literals are constants.
#[derive(Clone, Debug)]
struct Number(Taylor);

impl Default for Number {
    fn default() -> Self {
        Number(Taylor::constant(0.0))
    }
}

impl FromStr for Number {
    type Err = std::num::ParseFloatError;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        text.parse().map(|x| Number(Taylor::constant(x)))
    }
}

fn binary(apply: fn(Number, Number) -> Number, prio: i64, is_commutative: bool) -> BinOp<Number> {
    BinOp { apply, prio, is_commutative }
}

/// `a^b`: a power if `b` is a constant, `exp(b ln a)` otherwise.
fn power(Number(a): Number, Number(b): Number) -> Number {
    let is_constant = (0..=b.order()).all(|n| (0..=n).all(|j| n == 0 || b.derivative(n - j, j) == 0.0));
    Number(if is_constant { a.powf(b.value()) } else { (b * a.ln()).exp() })
}

literal_matcher_from_pattern!(Literal, r"^([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?");

ops_factory!(
    Functions,
    Number,
    Operator::make_bin("^", binary(power, 4, false)),
    Operator::make_bin("*", binary(|a, b| Number(a.0 * b.0), 2, true)),
    Operator::make_bin("/", binary(|a, b| Number(a.0 / b.0), 3, false)),
    Operator::make_bin_unary("+", binary(|a, b| Number(a.0 + b.0), 0, true), |a| a),
    Operator::make_bin_unary("-", binary(|a, b| Number(a.0 - b.0), 1, false), |a| Number(-a.0)),
    Operator::make_bin("atan2", binary(|y, x| Number(y.0.atan2(&x.0)), 0, false)),
    Operator::make_unary("sin", |a| Number(a.0.sin())),
    Operator::make_unary("cos", |a| Number(a.0.cos())),
    Operator::make_unary("exp", |a| Number(a.0.exp())),
    Operator::make_unary("ln", |a| Number(a.0.ln())),
    Operator::make_unary("sqrt", |a| Number(a.0.sqrt())),
    Operator::make_constant("pi", Number(Taylor::constant(std::f64::consts::PI)))
);

/// A formula in the coordinates `x`, `y`, `z` of a point: `+ - * / ^`, `sin`, `cos`, `exp`, `ln`, `sqrt`, `atan2(y, x)`,
/// `pi`, brackets. Its derivatives are exact.
#[derive(Clone, Debug)]
pub struct Expression {
    parsed: FlatEx<Number, Functions, Literal>,
    /// Which coordinates it has, in the order in which it wants them.
    coordinates: Vec<usize>,
}

impl Expression {
    /// Reads a formula.
    ///
    /// # Errors
    /// [`StudyError::Expression`] if it makes no sense.
    pub fn parse(text: &str) -> Result<Self, StudyError> {
        let wrong = |reason: String| StudyError::Expression { text: text.to_owned(), reason };
        let signed = signs_as_differences(text).map_err(wrong)?;
        let parsed = FlatEx::parse(&signed).map_err(|error| wrong(error.to_string()))?;
        let coordinate = |name: &String| {
            ["x", "y", "z"].iter().position(|&c| c == name).ok_or_else(|| {
                wrong(format!("{name} is unknown: there are x, y, z, pi, sin, cos, exp, ln, sqrt and atan2"))
            })
        };
        let coordinates = parsed.var_names().iter().map(coordinate).collect::<Result<_, _>>()?;
        Ok(Expression { parsed, coordinates })
    }

    /// Its value where the coordinates have these.
    pub fn at(&self, point: &[Taylor; 3]) -> Taylor {
        let arguments: Vec<Number> = self.coordinates.iter().map(|&k| Number(point[k])).collect();
        self.parsed.eval(&arguments).expect("every coordinate is given").0
    }
}

/// A formula with `-a` as `0-a`, because the parser takes a sign before it takes powers: its `-x^2` is `(-x)^2`.
fn signs_as_differences(text: &str) -> Result<String, String> {
    let (mut signed, mut before) = (String::new(), '(');
    for c in text.chars() {
        match (before, c) {
            ('(' | ',', '-' | '+') => signed.push('0'),
            ('+' | '-' | '*' | '/', '-' | '+') => {
                return Err(format!("a sign follows {before}: put it in brackets with what it belongs to"));
            }
            _ => {}
        }
        signed.push(c);
        before = if c.is_whitespace() { before } else { c };
    }
    Ok(signed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_what_they_say() {
        let [x, y] = Taylor::variables([0.3, -0.8], 4);
        let point = [x, y, Taylor::constant(2.0)];
        let c = Taylor::constant;
        let pi = c(std::f64::consts::PI);
        let cases: [(&str, Taylor); 9] = [
            ("cos(2*pi*x) - sin(4*pi*y)", (pi * x * 2.0).cos() - (pi * y * 4.0).sin()),
            ("x + y + y*(1-y)/4", x + y + y * (c(1.0) - y) * 0.25),
            ("-x^2 - 2^3", -(x * x) - c(8.0)),
            ("2*(-x^2) - x^-1", -(x * x * 2.0) - c(1.0) / x),
            ("cos( - x^2) + 1e-3*y", (x * x).cos() + y * 1e-3),
            ("(x^2 + y^2)^(1/3)", (x * x + y * y).powf(1.0 / 3.0)),
            ("z - x - y - 1", c(2.0) - x - y - c(1.0)),
            ("atan2(-y, -x) + pi", (-y).atan2(&-x) + pi),
            (
                "sqrt(1 + x^2) * exp(x*y) / ln(3 + y)",
                (c(1.0) + x * x).sqrt() * (x * y).exp() / (c(3.0) + y).ln(),
            ),
        ];
        for (text, expected) in cases {
            let found = Expression::parse(text).unwrap().at(&point);
            for n in 0..=4 {
                for j in 0..=n {
                    let (a, b) = (found.derivative(n - j, j), expected.derivative(n - j, j));
                    assert!((a - b).abs() < 1e-11 * (1.0 + b.abs()), "{text}: {a} {b}");
                }
            }
        }
        for text in ["2*-x^2", "x +", "w", "sin(x", "tan(x)", ""] {
            assert!(Expression::parse(text).is_err(), "{text}");
        }
    }
}
