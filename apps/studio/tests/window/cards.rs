//! Cards are baked on their page, and the levels are shown in place of the strands.

use crate::{SPACE, display::Desk, turn};

/// Places in a window of 1280 × 720, pixels.
const PAGE: [i16; 2] = [1067, 57];
const BAKE: [i16; 2] = [918, 181];
const STRANDS: [i16; 2] = [908, 240];
const COARSEST: [i16; 2] = [908, 321];
const BY_SIZE: [i16; 2] = [904, 385];

#[test]
fn cards_are_baked_and_shown_in_place_of_strands() {
    let Some(_turn) = turn() else { return };
    let mut desk = Desk::open(&["style.strands=3000"]);
    desk.show_hair();
    desk.key(SPACE);
    let strands = desk.still();
    desk.click(PAGE);
    desk.click(BAKE);
    let shows = |desk: &mut Desk, name: &str| {
        desk.wait_for(name, |desk| {
            let state = desk.state()?;
            assert_eq!(state["error"], "");
            (state["cards"] == name).then_some(())
        });
        let shot = desk.still();
        shot.keep(name);
        shot
    };
    let cards = shows(&mut desk, "400 cards");
    assert!(cards.hair() > 0.02 && cards.change(&strands) > 0.05);
    desk.click(COARSEST);
    let coarse = shows(&mut desk, "40 cards");
    assert!(coarse.change(&cards) > 0.02);
    desk.click(STRANDS);
    let again = shows(&mut desk, "strands");
    let [left, other] = [&again, &cards].map(|shot| shot.change(&strands));
    assert!(left < 0.6 * other, "strands again: {left}, cards {other}");
    // From afar, the level follows from the size.
    desk.click(BY_SIZE);
    for _ in 0..30 {
        desk.wheel([400, 300], false);
    }
    shows(&mut desk, "40 cards");
    assert!(desk.close().success());
}
