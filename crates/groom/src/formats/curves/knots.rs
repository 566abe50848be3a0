//! Knots of B-splines.

#[cfg(feature = "alembic")]
use super::basis::MAX_ORDER;

/// Returns uniform knots, repeated at both ends so that curves reach their outermost points, for files with orders but
/// without knots.
#[cfg(feature = "alembic")]
pub(in crate::formats) fn clamped(starts: &[u32], orders: &[f32]) -> Option<Vec<(usize, Vec<f32>)>> {
    let curves = starts.len() - 1;
    (orders.len() == curves).then(|| {
        let each = starts.windows(2).zip(orders);
        each.map(|(w, order)| {
            let points = (w[1] - w[0]) as usize;
            let order = (*order as usize).clamp(2, MAX_ORDER).min(points.max(2));
            let spans = (points + 1).saturating_sub(order);
            (order, (0..points + order).map(|k| k.saturating_sub(order - 1).min(spans) as f32).collect())
        })
        .collect()
    })
}

/// Returns the order and the knots of each curve, if their number fits the curves.
pub(in crate::formats) fn split_knots(
    starts: &[u32],
    orders: &[f32],
    knots: &[f32],
    variable: bool,
) -> Option<Vec<(usize, Vec<f32>)>> {
    if knots.is_empty() || (variable && orders.is_empty()) {
        return None;
    }
    let curves = starts.len() - 1;
    let order = |i: usize| match orders.len() {
        0 => 4,
        // Valid files store 8-bit orders.
        1 => orders[0] as u8 as usize,
        n if n == curves => orders[i] as u8 as usize,
        _ => 0,
    };
    let needs =
        |i: usize, fewer: usize| ((starts[i + 1] - starts[i]) as usize + order(i)).saturating_sub(fewer);
    // Maya omits the first and the last knot.
    let fewer = [0, 2]
        .into_iter()
        .find(|fewer| (0..curves).map(|i| needs(i, *fewer)).sum::<usize>() == knots.len())?;
    let mut rest = knots;
    let mut all = Vec::with_capacity(curves);
    for i in 0..curves {
        let (own, more) = rest.split_at_checked(needs(i, fewer))?;
        rest = more;
        let mut own = own.to_vec();
        if fewer == 2 {
            own.insert(0, *own.first()?);
            own.push(*own.last()?);
        }
        all.push((order(i), own));
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    #[cfg(feature = "alembic")]
    use glam::Vec3;

    use super::*;
    #[cfg(feature = "alembic")]
    use crate::formats::curves::basis::Basis;

    #[test]
    fn knots_are_split_among_curves() {
        let starts = [0, 4, 9];
        // Points plus order, or two fewer as in Maya.
        let whole: Vec<f32> = (0..8).chain(0..9).map(|k| k as f32).collect();
        let split = split_knots(&starts, &[], &whole, false).unwrap();
        assert_eq!((split[0].0, split[0].1.len(), split[1].1.len()), (4, 8, 9));
        let fewer: Vec<f32> = (1..7).chain(1..8).map(|k| k as f32).collect();
        let split = split_knots(&starts, &[4.0], &fewer, true).unwrap();
        assert_eq!(split[0].1, [1.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 6.0]);
        let mixed = split_knots(&starts, &[2.0, 4.0], &whole[..15], true).unwrap();
        assert_eq!((mixed[0].0, mixed[0].1.len(), mixed[1].1.len()), (2, 6, 9));
        for (orders, knots) in [(&[][..], &whole[..]), (&[4.0], &whole[..5]), (&[4.0, 4.0, 4.0], &whole)] {
            assert!(split_knots(&starts, orders, knots, true).is_none());
        }
    }

    #[test]
    #[cfg(feature = "alembic")]
    fn clamped_curves_reach_their_outermost_points() {
        let points: Vec<Vec3> = (0..7).map(|k| Vec3::new((k * k) as f32, 1.0 - k as f32, 0.0)).collect();
        for order in [2.0, 3.0, 4.0, 7.0, 200.0] {
            let (order, knots) = clamped(&[0, 7], &[order]).unwrap().remove(0);
            assert_eq!(knots.len(), 7 + order);
            let line = Basis::Knots { order, knots: &knots }.vertices(7).unwrap();
            let ends = [line.first(), line.last()].map(|blend| blend.unwrap().of_values(&points));
            assert!(ends[0].distance(points[0]) + ends[1].distance(points[6]) < 1e-4, "{order}: {ends:?}");
        }
        assert!(clamped(&[0, 7], &[]).is_none());
    }
}
