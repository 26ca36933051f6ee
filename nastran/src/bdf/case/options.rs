//! Options and values of the case control commands that select loads and constraints.

/// Returns whether an option is the keyword, or an abbreviation of it to four letters or more.
pub(super) fn abbreviates(option: &str, word: &str) -> bool {
    option == word || option.len() >= 4 && word.starts_with(option)
}

/// Returns the fault in the options of a command. Returns `None` if Nastran knows all of them, or if the command has only output options.
///
/// # Reference
/// MSC Nastran 2022.4 and Simcenter Nastran quick reference guides, case control commands.
pub(super) fn unknown_option(word: &str, options: &[String]) -> Option<&'static str> {
    let (known, why): (&[&str], _) = match word {
        "LOAD" | "SPC" | "MPC" | "NSM" | "SUPORT1" | "DEFORM" | "SUBSEQ" | "SYMSEQ"
        | "ANALYSIS" | "RIGID" => (&[], "the command has no options"),
        "TEMPERATURE" => (
            &["INITIAL", "MATERIAL", "LOAD", "BOTH"],
            "the option must be INITIAL, MATERIAL, LOAD or BOTH",
        ),
        "METHOD" => (
            &["STRUCTURE", "FLUID", "COUPLED", "BOTH"],
            "the option must be STRUCTURE, FLUID, COUPLED or BOTH",
        ),
        _ => return None,
    };
    let knows = |o: &String| known.iter().any(|k| abbreviates(o, k));
    (!options.iter().all(knows)).then_some(why)
}

/// Values of ANALYSIS.
const ANALYSES: [&str; 33] = [
    "STATICS",
    "MODES",
    "BUCKLING",
    "DFREQ",
    "MFREQ",
    "DTRAN",
    "MTRAN",
    "DCEIG",
    "MCEIG",
    "SAERO",
    "FLUTTER",
    "DIVERGE",
    "HEAT",
    "HSTAT",
    "HTRAN",
    "HOT2COLD",
    "STRUCTURE",
    "NLSTATICS",
    "NLTRANS",
    "LNSTATICS",
    "CYCMODES",
    "CYCSTAT",
    "RCTEST",
    "RANDOM",
    "PRELOAD",
    "FOURIER",
    "MULTIMBD",
    "MBD",
    "ACOUSTIC",
    "FNASTRAN",
    "SEMODES",
    "SESTATIC",
    "LINEAR",
];

/// Values of RIGID.
const RIGIDS: [&str; 7] = [
    "LINEAR", "LAGRANGE", "LGELIM", "LELIM", "STATIC", "PENALTY", "AUTO",
];

/// Returns the fault in a value (upper case) of a command whose values are a fixed list.
pub(super) fn unknown_value(word: &str, value: &str) -> Option<&'static str> {
    let (known, why): (&[&str], _) = match word {
        "ANALYSIS" => (&ANALYSES, "Nastran has no analysis of this name"),
        "RIGID" => (&RIGIDS, "Nastran has no such method of rigid elements"),
        _ => return None,
    };
    let value = value.trim_matches(['\'', '"']);
    (!known.iter().any(|k| abbreviates(value, k))).then_some(why)
}
