//! Parameters of the deck.

/// Parameters that affect the model, its solution or its output, with the value of the deck or the default.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// WTMASS, default 1.
    pub wtmass: f64,
    /// GRDPNT, `None` where absent.
    pub grdpnt: Option<u32>,
    /// INREL, default 0.
    pub inrel: i32,
    /// K6ROT, default 100.
    pub k6rot: f64,
    /// SNORM in radians, default 20 degrees.
    pub snorm_rad: f64,
    /// AUTOSPC, default yes.
    pub autospc: bool,
    /// COUPMASS > 0.
    pub coupmass: bool,
    /// POST.
    pub post: Option<i64>,
    /// OMID yes: element output in the material frame.
    pub omid: bool,
    /// Whether case control lets rigid elements expand with temperature (RIGID = LAGRAN or LGELIM).
    pub expanding_rigids: bool,
    /// UNITSYS as written.
    pub unitsys: Option<String>,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            wtmass: 1.0,
            grdpnt: None,
            inrel: 0,
            k6rot: 100.0,
            snorm_rad: 20_f64.to_radians(),
            autospc: true,
            coupmass: false,
            post: None,
            omid: false,
            expanding_rigids: false,
            unitsys: None,
        }
    }
}
