//! Numbers and widths that the panels of values share.

/// Width of the names of values, points.
pub const NAME_WIDTH: f32 = 136.0;

/// Formats a number with three significant digits.
pub fn short(number: f64) -> String {
    if number == 0.0 {
        return "0".into();
    }
    let before = number.abs().log10().floor() as i32 + 1;
    let text = format!("{number:.*}", (3 - before).clamp(0, 9) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (number, text) in
            [(0.0, "0"), (9.81, "9.81"), (12.0, "12"), (0.0035, "0.0035"), (1234.6, "1235"), (20.04, "20")]
        {
            assert_eq!(short(number), text);
        }
    }
}
