//! Seeded damage to every kind of input: a reader ends in an answer or an error, soon, and never in a panic.
//!
//! `STRAINBRIDGE_MUTATIONS` sets how many (`.ci/long`: a million); the seed is printed with a failure.

use nastran::bdf::{MemoryLoader, read_deck};
use nastran::op2::write_blocks;
use nastran::results::{
    Analysis, Block, ElementType, Quantity, ResultsFile, RowId, Rows, Salvaged, ShellForm, columns,
};
use std::time::{Duration, Instant};
use strainbridge::app::context::InMemory;
use strainbridge::app::job::Job;
use strainbridge::app::job::table::read_table;
use strainbridge::model::Model;
use strainbridge::series::{binary, csv, rpc};

/// Mutations where nothing else is asked for: some seconds.
const USUAL: u64 = 4_000;
/// The longest that a reader may take over a file of some kilobytes.
const LONGEST: Duration = Duration::from_secs(20);

/// A small generator, the same everywhere (splitmix64; Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

const DECK: &str = "SOL 101\nCEND\nSPC = 1\nSUBCASE 1\n LOAD = 2\n STRAIN(FIBER) = ALL\nBEGIN BULK\n\
PARAM,INREL,-2\nMAT1,1,2.1+5,,.3,7.85-9\nPSHELL,1,1,2.,1,,1\nPBARL,2,1,,ROD\n,5.\n\
GRID,1,,0.,0.,0.\nGRID,2,,10.,0.,0.\nGRID,3,,10.,10.,0.\nGRID*,4,,0.,10.\n*,0.\n=,=,=,*(1.),==\n=(3)\n\
CQUAD4,1,1,1,2,3,4\nCTRIA3,2,1,1,2,3\nCBAR,3,2,1,2,0.,0.,1.\nRBE2,4,1,123456,2,3\nCORD2R,5,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n\
SPC1,1,123456,1,THRU,2\nSPCADD,3,1\nFORCE,2,3,,5.,0.,0.,1.\nLOAD,4,1.,1.,2\nPLOAD4,6,1,3.\nENDDATA\n";

const JOB: &str = "title = \"t\"\nunits = \"mm-t-s\"\n[model]\ndeck = \"d.bdf\"\n[[load]]\nname = \"A\"\ngrid = 3\ncomponent = \"FZ\"\n\
expected = 100.0\n[[gauge]]\nname = \"g1\"\nelement = 1\nsurface = \"top\"\ndirection = [1, 0, 0]\n[candidates]\nsurfaces = [\"top\"]\n\
[placement]\ngauges = 2\nspacing = 1.0\n[measured]\nstrain = \"s.csv\"\nnoise_microstrain = 1.0\n";

const TABLE: &str = "time,g1,g2\n0,1.5,-2\n0.01,1e3,\"4\"\n0.02,,nan\n";

const PUNCH: &str = "$TITLE   = A                                                                       1\n\
$SUBTITLE=                                                                         2\n\
$LABEL   =                                                                         3\n\
$DISPLACEMENTS                                                                     4\n\
$REAL OUTPUT                                                                       5\n\
$SUBCASE ID =           1                                                          6\n\
         1       G      1.000000E+00      2.000000E+00      3.000000E+00       7\n\
-CONT-                  4.000000E+00      5.000000E+00      6.000000E+00       8\n";

fn op2() -> Vec<u8> {
    let block = Block {
        table: String::new(),
        quantity: Quantity::Strain,
        analysis: Analysis::Statics,
        subcase: 1,
        mode: 0,
        step: 0.0,
        element: Some(ElementType(33)),
        form: Some(ShellForm::Fiber),
        von_mises: true,
        complex: false,
        sort2: false,
        num_wide: 0,
        entries: 0,
        titles: Default::default(),
    };
    let ids = (1..=4).flat_map(|entity| {
        [1, 2].map(|layer| RowId {
            entity,
            at: 0,
            layer,
        })
    });
    let ids: Vec<RowId> = ids.collect();
    let rows = Rows {
        columns: columns::SHELL_STRAIN,
        values: vec![1e-4; ids.len() * columns::SHELL_STRAIN.len()],
        ids,
        labels: Vec::new(),
    };
    write_blocks([(&block, &rows), (&block, &rows)], [11, 22, 2026]).unwrap()
}

/// One change: a bit, a word that hurts, a piece taken out, doubled, or a cut.
fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    const WORDS: [&[u8]; 12] = [
        &[0; 4],
        &[0xff; 4],
        &[0xff, 0xff, 0xff, 0x7f],
        &[0, 0, 0, 0x80],
        b"1e308",
        b"-99999999999",
        b"nan",
        b"THRU",
        b"\n",
        b",",
        b"\"",
        b"[[",
    ];
    if bytes.is_empty() {
        return;
    }
    let at = random.below(bytes.len());
    let len = random.below(64.min(bytes.len() - at));
    match random.below(6) {
        0 | 1 => bytes[at] ^= 1 << random.below(8),
        2 => {
            let word = WORDS[random.below(WORDS.len())];
            let end = (at + word.len()).min(bytes.len());
            bytes.splice(at..end, word.iter().copied());
        }
        3 => drop(bytes.drain(at..at + len)),
        4 => {
            let piece = bytes[at..at + len].to_vec();
            let to = random.below(bytes.len());
            bytes.splice(to..to, piece);
        }
        _ => bytes.truncate(at),
    }
}

fn results(bytes: &[u8]) {
    if let Ok(Salvaged { file, .. }) = ResultsFile::salvage(bytes, "x.op2") {
        for i in 0..file.blocks().len() {
            let _ = file.rows(i);
        }
        let _ = (file.cards(), file.grid_point_weight());
    }
}

fn deck(bytes: &[u8]) {
    let deck = read_deck("d.bdf", bytes.to_vec(), &mut MemoryLoader::default());
    let _ = Model::from_deck(&deck);
}

fn job(bytes: &[u8]) {
    let files = InMemory::default().with("job.toml", bytes);
    let _ = Job::read("job.toml", &files);
}

fn table(bytes: &[u8]) {
    let _ = read_table("t.csv", &String::from_utf8_lossy(bytes));
    let _ = csv::read_csv(bytes, None);
    if binary::is_record(bytes)
        && let Ok(h) = binary::read_header(bytes)
    {
        let mut out = Vec::new();
        binary::read_samples(&h, bytes, 0, h.samples.min(1000), &[Some(0)], &mut out);
    }
    let _ = rpc::read_rpc(bytes);
}

type Reader = fn(&[u8]);

#[test]
fn damaged_inputs_end_in_an_answer_or_an_error() {
    let wanted = std::env::var("STRAINBRIDGE_MUTATIONS").ok();
    let wanted = wanted.and_then(|n| n.parse().ok()).unwrap_or(USUAL);
    let samples: [(&str, Vec<u8>, Reader); 5] = [
        ("deck", DECK.into(), deck),
        ("punch", PUNCH.into(), results),
        ("op2", op2(), results),
        ("job", JOB.into(), job),
        ("table", TABLE.into(), table),
    ];
    let mut slowest = Duration::ZERO;
    for seed in 0..wanted {
        let mut random = Random(seed);
        let (name, original, read) = &samples[random.below(samples.len())];
        let mut bytes = original.clone();
        for _ in 0..=random.below(5) {
            mutate(&mut bytes, &mut random);
        }
        let start = Instant::now();
        let ended = std::panic::catch_unwind(|| read(&bytes));
        assert!(ended.is_ok(), "{name}, seed {seed}");
        slowest = slowest.max(start.elapsed());
        assert!(slowest < LONGEST, "{name}, seed {seed}: {slowest:?}");
    }
    println!("{wanted} mutations, seeds 0 to {wanted}, the slowest {slowest:?}");
}
