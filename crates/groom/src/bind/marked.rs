//! Guides marked in a file, and the file's assignment of strands to them.

use std::collections::HashMap;

use super::{BindOptions, GuideCount};
use crate::{Strands, bound::Influence};

/// Guides marked in a file.
pub(super) struct MarkedGuides {
    pub guides: Vec<u32>,
    /// Index of each guide by its id in the file.
    by_id: HashMap<i32, u32>,
    /// Whether the file also has strands that are not guides.
    pub others: bool,
}

impl MarkedGuides {
    /// Collects the marked guides among the first `given` strands. Returns `None` without marked guides, or if
    /// `options.guides` is not [`GuideCount::OneIn`].
    pub fn of(strands: &Strands, given: usize, options: &BindOptions) -> Option<Self> {
        let marks = strands.marks.get(..given).filter(|_| matches!(options.guides, GuideCount::OneIn(_)))?;
        let guides: Vec<u32> = (0u32..).zip(marks).filter(|(_, mark)| mark.guide).map(|(i, _)| i).collect();
        let by_id = (0u32..).zip(&guides).map(|(k, i)| (marks[*i as usize].id, k)).collect();
        (!guides.is_empty()).then_some(Self { others: guides.len() < given, guides, by_id })
    }

    /// Returns the guides that the file assigns to strand `i`, if any.
    pub fn follow(&self, strands: &Strands, i: usize) -> Option<Vec<Influence>> {
        let mark = strands.marks.get(i)?;
        let mut found: Vec<Influence> = Vec::new();
        for (id, weight) in mark.closest.iter().zip(mark.weights).filter(|(_, weight)| *weight > 0.0) {
            let guide = *self.by_id.get(id)?;
            match found.iter_mut().find(|known| known.guide == guide) {
                Some(known) => known.weight += weight,
                None => found.push(Influence { guide, weight, scale: 1.0 }),
            }
        }
        let sum: f32 = found.iter().map(|influence| influence.weight).sum();
        found.iter_mut().for_each(|influence| influence.weight /= sum);
        (sum > 0.0 && sum.is_finite()).then_some(found)
    }
}
