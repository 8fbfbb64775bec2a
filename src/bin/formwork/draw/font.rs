//! A stroke font for pictures without fonts: digits, letters and a few signs, drawn as polylines.

use super::Point;

/// A glyph: strokes of points `xy` in a box 4 wide and 8 tall, the baseline at 2 and small letters up to 6.
const GLYPHS: &[(char, &str)] = &[
    ('0', "03 07 18 38 47 43 32 12 03"),
    ('1', "17 28 22"),
    ('2', "07 18 38 47 46 02 42"),
    ('3', "07 18 38 47 46 35 15|35 44 43 32 12 03"),
    ('4', "32 38 04 44"),
    ('5', "48 08 05 35 44 43 32 12 03"),
    ('6', "38 18 07 03 12 32 43 44 35 05"),
    ('7', "08 48 12"),
    ('8', "15 06 07 18 38 47 46 35 15 04 03 12 32 43 44 35"),
    ('9', "45 15 06 07 18 38 47 43 32 12"),
    ('a', "42 46|45 36 16 05 03 12 32 43"),
    ('b', "08 02|03 12 32 43 45 36 16 05"),
    ('c', "45 36 16 05 03 12 32 43"),
    ('d', "48 42|43 32 12 03 05 16 36 45"),
    ('e', "04 44 45 36 16 05 03 12 32 43"),
    ('f', "38 28 17 12|06 36"),
    ('g', "46 41 30 10|45 36 16 05 03 12 32 43"),
    ('h', "08 02|05 16 36 45 42"),
    ('i', "22 26|28 28"),
    ('j', "26 21 10 00|28 28"),
    ('k', "08 02|46 04 42"),
    ('l', "28 22"),
    ('m', "02 06|05 16 25 22|25 36 45 42"),
    ('n', "02 06|05 16 36 45 42"),
    ('o', "03 05 16 36 45 43 32 12 03"),
    ('p', "00 06|05 16 36 45 43 32 12 03"),
    ('q', "40 46|45 36 16 05 03 12 32 43"),
    ('r', "02 06|04 16 36"),
    ('s', "45 36 16 05 14 34 43 32 12 03"),
    ('t', "18 13 22 32|06 36"),
    ('u', "06 03 12 32 43|46 42"),
    ('v', "06 22 46"),
    ('w', "06 12 25 32 46"),
    ('x', "06 42|02 46"),
    ('y', "06 22|46 22 10 00"),
    ('z', "06 46 02 42"),
    ('A', "02 28 42|14 34"),
    ('B', "02 08 38 47 46 35 05|35 44 43 32 02"),
    ('C', "47 38 18 07 03 12 32 43"),
    ('D', "02 08 28 46 44 22 02"),
    ('E', "48 08 02 42|05 35"),
    ('F', "48 08 02|05 35"),
    ('J', "48 43 32 12 03"),
    ('L', "08 02 42"),
    ('M', "02 08 25 48 42"),
    ('N', "02 08 42 48"),
    ('S', "47 38 18 07 06 15 35 44 43 32 12 03"),
    ('W', "08 12 25 32 48"),
    ('.', "22 22"),
    (',', "22 11"),
    (':', "22 22|25 25"),
    ('-', "14 34"),
    ('+', "04 44|22 26"),
    ('=', "05 45|03 43"),
    ('/', "02 48"),
    ('(', "38 26 24 32"),
    (')', "18 26 24 12"),
    ('^', "16 28 36"),
];

/// The width of a letter, and the space after it.
fn width(letter: char) -> f64 {
    match letter {
        'i' | 'l' | '.' | ',' | ':' => 1.0,
        '1' | '(' | ')' | 'j' => 2.0,
        'f' | 't' | 'r' | ' ' => 3.0,
        _ => 4.0,
    }
}

/// Where the box of a narrow letter starts in the grid.
fn left(letter: char) -> f64 {
    match letter {
        'i' | 'l' | '.' | ',' | ':' => 1.5,
        '1' | '(' | ')' => 1.0,
        _ => 0.0,
    }
}

const GAP: f64 = 1.6;

/// The strokes of a line of text. A sign that the font does not have is a gap.
pub fn strokes(text: &str, at: Point, size: f64, anchor: f64) -> Vec<Vec<Point>> {
    // Capitals are 6 units tall and 0.72 of the size.
    let unit = 0.72 * size / 6.0;
    let total: f64 = text.chars().map(|c| width(c) + GAP).sum::<f64>() - GAP;
    let mut x = at[0] - anchor * total * unit;
    let mut strokes = Vec::new();
    for letter in text.chars() {
        let glyph = GLYPHS.iter().find(|(c, _)| *c == letter).map_or("", |(_, glyph)| glyph);
        for stroke in glyph.split('|').filter(|s| !s.is_empty()) {
            let point = |xy: &str| {
                let xy = xy.as_bytes();
                let [px, py] = [xy[0], xy[1]].map(|b| f64::from(b - b'0'));
                [x + (px - left(letter)) * unit, at[1] - (py - 2.0) * unit]
            };
            let mut line: Vec<Point> = stroke.split(' ').map(point).collect();
            // A point is a short stroke with round ends.
            if line[0] == line[1] {
                line[1][0] += 0.01 * unit;
            }
            strokes.push(line);
        }
        x += (width(letter) + GAP) * unit;
    }
    strokes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_as_wide_as_it_is_anchored() {
        let right = |anchor| {
            let strokes = strokes("0.50", [0.0, 0.0], 12.0, anchor);
            strokes.iter().flatten().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max)
        };
        assert!((right(0.0) - 2.0 * right(0.5)).abs() < 1e-9 && right(1.0).abs() < 1e-9);
        assert!(GLYPHS.iter().all(|(_, glyph)| glyph.split(['|', ' ']).all(|p| p.len() == 2)));
    }
}
