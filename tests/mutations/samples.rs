//! Small valid files of every supported kind.

use nastran::op2::write_blocks;
use nastran::results::{Analysis, Block, ElementType, Quantity, RowId, Rows, ShellForm, columns};
use strainbridge::series::{binary, rpc};

pub const DECK: &str = "SOL 101\nCEND\nSPC = 1\nSUBCASE 1\n LOAD = 2\n STRAIN(FIBER) = ALL\nBEGIN BULK\n\
PARAM,INREL,-2\nMAT1,1,2.1+5,,.3,7.85-9\nPSHELL,1,1,2.,1,,1\nPBARL,2,1,,ROD\n,5.\n\
GRID,1,,0.,0.,0.\nGRID,2,,10.,0.,0.\nGRID,3,,10.,10.,0.\nGRID*,4,,0.,10.\n*,0.\n=,*1,=,*(1.),==\n=3\n\
CQUAD4,1,1,1,2,3,4\nCTRIA3,2,1,1,2,3\nCBAR,3,2,1,2,0.,0.,1.\nRBE2,4,1,123456,2,3\nCORD2R,5,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n\
SPC1,1,123456,1,THRU,2\nSPCADD,3,1\nFORCE,2,3,,5.,0.,0.,1.\nLOAD,4,1.,1.,2\nPLOAD4,6,1,3.\nENDDATA\n";

pub const JOB: &str = "title = \"t\"\nunits = \"mm-t-s\"\n[model]\ndeck = \"d.bdf\"\nmesh_error = false\n[[load]]\nname = \"A\"\ngrid = 3\ncomponent = \"FZ\"\n\
expected = 100.0\n[[gauge]]\nname = \"g1\"\nelement = 1\nsurface = \"top\"\ndirection = [1, 0, 0]\n[candidates]\nsurfaces = [\"top\"]\n\
[placement]\ngauges = 2\nspacing = 1.0\n[measured]\nstrain = \"s.csv\"\nnoise_microstrain = 1.0\n";

pub const TABLE: &str = "time,g1,g2\n0,1.5,-2\n0.01,1e3,\"4\"\n0.02,,nan\n0.03,2,#N/A\n0.05,1,1\n";

/// Returns displacements of a subcase as a punch file. The last eight columns of each line contain its number.
pub fn punch() -> Vec<u8> {
    let lines = [
        "$TITLE   = A",
        "$SUBTITLE=",
        "$LABEL   =",
        "$DISPLACEMENTS",
        "$REAL OUTPUT",
        "$SUBCASE ID =           1",
        "         1       G      1.000000E+00      2.000000E+00      3.000000E+00",
        "-CONT-                  4.000000E+00      5.000000E+00      6.000000E+00",
        "         2       G      1.000000E-06      0.000000E+00      0.000000E+00",
        "-CONT-                  0.000000E+00      0.000000E+00      0.000000E+00",
    ];
    let numbered = lines.iter().enumerate();
    let text: String = numbered
        .map(|(i, l)| format!("{l:<72}{:8}\n", i + 1))
        .collect();
    text.into()
}

/// Number of samples of each record.
const N: usize = 40;
const STEP_S: f64 = 0.01;

fn value(i: usize, channel: usize) -> f64 {
    100.0 * (0.3 * i as f64 + channel as f64).sin()
}

fn names() -> Vec<String> {
    vec!["g1".into(), "g2".into()]
}

pub fn op2() -> Vec<u8> {
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

/// Returns displacements of two subcases in Nastran's HDF5 format, in compressed chunks.
pub fn h5() -> Vec<u8> {
    use hdf5_pure::{CompoundTypeBuilder, FileBuilder};
    let mut file = FileBuilder::new();
    let mut top = file.create_group("NASTRAN");
    let mut result = top.create_group("RESULT");
    let fields = ["ID", "SUBCASE", "ANALYSIS"];
    let kind = fields
        .iter()
        .fold(CompoundTypeBuilder::new(), |t, f| t.i64_field(f));
    let domains = [[1, 1, 1], [2, 2, 1]];
    let bytes = domains.iter().flatten().flat_map(|n: &i64| n.to_le_bytes());
    result
        .create_dataset("DOMAINS")
        .with_compound_data(kind.build().unwrap(), bytes.collect(), 2);
    let mut kind = CompoundTypeBuilder::new().i64_field("ID");
    for f in ["X", "Y", "Z", "RX", "RY", "RZ"] {
        kind = kind.f64_field(f);
    }
    let kind = kind.i64_field("DOMAIN_ID").build().unwrap();
    let mut bytes = Vec::new();
    for i in 0..12_i64 {
        bytes.extend((1 + i % 6).to_le_bytes());
        (0..6).for_each(|c| bytes.extend(value(i as usize, c).to_le_bytes()));
        bytes.extend((1 + i / 6).to_le_bytes());
    }
    let mut nodal = result.create_group("NODAL");
    nodal
        .create_dataset("DISPLACEMENT")
        .with_compound_data(kind, bytes, 12)
        .with_chunks(&[5])
        .with_deflate(6);
    result.add_group(nodal.finish());
    top.add_group(result.finish());
    file.add_group(top.finish());
    file.finish().unwrap()
}

/// Returns a binary record of strainbridge.
pub fn binary_record() -> Vec<u8> {
    let mut out = Vec::new();
    binary::write_header(&mut out, &names(), N as u64, 0.0, STEP_S, 1.0).unwrap();
    for i in 0..N {
        (0..2).for_each(|c| out.extend((value(i, c) as f32).to_le_bytes()));
    }
    out
}

pub fn rpc3() -> Vec<u8> {
    let target = |name: String| rpc::Target {
        name,
        unit: "um/m".into(),
        min: -100.0,
        max: 100.0,
    };
    let targets: Vec<rpc::Target> = names().into_iter().map(target).collect();
    let mut out = Vec::new();
    let rows = |from: usize, to: usize, out: &mut Vec<f64>| {
        out.extend((from..to).flat_map(|i| [value(i, 0), value(i, 1)]));
    };
    rpc::write_rpc(&mut out, &targets, STEP_S, N, rows).unwrap();
    out
}

#[cfg(feature = "parquet")]
pub fn parquet() -> Vec<u8> {
    let rows = |from: usize, to: usize, out: &mut Vec<f64>| {
        out.extend((from..to).flat_map(|i| [value(i, 0), value(i, 1)]));
    };
    strainbridge::series::parquet::parquet_bytes(&names(), &[], [0.0, STEP_S], N, rows).unwrap()
}

/// Returns an MDF4 file with two groups, compressed or not.
#[cfg(feature = "mdf")]
pub fn mdf4(deflated: bool) -> Vec<u8> {
    let times: Vec<f64> = (0..N).map(|i| STEP_S * i as f64).collect();
    let mut file = falcon_mdf::Mf4Writer::new();
    file.set_compression(deflated);
    for c in 0..2 {
        let values: Vec<f64> = (0..N).map(|i| value(i, c)).collect();
        let group = file.add_group(&times).unwrap();
        group.add_channel(&names()[c], "um/m", &values).unwrap();
    }
    let mut out = Vec::new();
    file.write(&mut out).unwrap();
    out
}

/// Returns a TDMS file with two segments: lists and samples, then only samples.
///
/// # Reference
/// National Instruments, TDMS File Format Internal Structure (2024).
pub fn tdms() -> Vec<u8> {
    fn text(out: &mut Vec<u8>, s: &str) {
        out.extend((s.len() as u32).to_le_bytes());
        out.extend(s.as_bytes());
    }
    let mut list = 2_u32.to_le_bytes().to_vec();
    for name in names() {
        text(&mut list, &format!("/'strain'/'{name}'"));
        list.extend(20_u32.to_le_bytes());
        list.extend([10_u32, 1].iter().flat_map(|w| w.to_le_bytes()));
        list.extend((N as u64 / 2).to_le_bytes());
        list.extend(2_u32.to_le_bytes());
        text(&mut list, "wf_increment");
        list.extend(10_u32.to_le_bytes());
        list.extend(STEP_S.to_le_bytes());
        text(&mut list, "unit_string");
        list.extend(0x20_u32.to_le_bytes());
        text(&mut list, "um/m");
    }
    let mut out = Vec::new();
    for half in 0..2 {
        let (flags, list): (u32, &[u8]) = if half == 0 {
            (0b1110, &list)
        } else {
            (0b1000, &[])
        };
        let data = (0..2).flat_map(|c| (0..N / 2).map(move |i| value(half * N / 2 + i, c)));
        let data: Vec<u8> = data.flat_map(f64::to_le_bytes).collect();
        out.extend(b"TDSm");
        out.extend([flags, 4713].iter().flat_map(|w| w.to_le_bytes()));
        out.extend(((list.len() + data.len()) as u64).to_le_bytes());
        out.extend((list.len() as u64).to_le_bytes());
        out.extend(list);
        out.extend(data);
    }
    out
}

/// Returns a universal file with data sets 58 as text or 58b.
///
/// # Reference
/// SDRC, Universal File Dataset 58 (Function at nodal DOF).
pub fn uff(binary: bool) -> Vec<u8> {
    let mut out = Vec::new();
    for (c, name) in names().iter().enumerate() {
        let data: Vec<f64> = (0..N).map(|i| value(i, c)).collect();
        let kind = if binary {
            format!(
                "    58b     1     2          11{:12}     0     0           0           0",
                8 * N
            )
        } else {
            "    58".to_owned()
        };
        out.extend(format!("    -1\n{kind}\n{name}\nNONE\nNONE\nNONE\nNONE\n").as_bytes());
        out.extend(
            format!(
                "    1         1    0         0 {name:>10}{:10}   3 {:>10}{:10}   0\n",
                c + 1,
                "NONE",
                0
            )
            .as_bytes(),
        );
        out.extend(
            format!(
                "{:10}{N:10}{:10}{:13.5E}{STEP_S:13.5E}{:13.5E}\n",
                4, 1, 0.0, 0.0
            )
            .as_bytes(),
        );
        out.extend(
            format!(
                "{:10}{:5}{:5}{:5} {:<20} {:<20}\n",
                17, 0, 0, 0, "Time", "s"
            )
            .as_bytes(),
        );
        out.extend(
            format!(
                "{:10}{:5}{:5}{:5} {:<20} {:<20}\n",
                3, 0, 0, 0, name, "um/m"
            )
            .as_bytes(),
        );
        out.extend(
            b"         0    0    0    0 NONE                 NONE                \n".repeat(2),
        );
        if binary {
            out.extend(data.iter().flat_map(|v| v.to_le_bytes()));
            out.push(b'\n');
        } else {
            for row in data.chunks(4) {
                let fields: Vec<String> = row.iter().map(|v| format!("{v:20.11E}")).collect();
                out.extend(format!("{}\n", fields.concat()).as_bytes());
            }
        }
        out.extend(b"    -1\n");
    }
    out
}

/// Returns a spreadsheet of runs.
#[cfg(feature = "report")]
pub fn xlsx() -> Vec<u8> {
    let mut book = rust_xlsxwriter::Workbook::new();
    let sheet = book.add_worksheet();
    for (c, name) in ["run", "g1", "g2"].iter().enumerate() {
        sheet.write_string(0, c as u16, *name).unwrap();
    }
    for r in 1..6 {
        sheet.write_string(r, 0, format!("R{r}")).unwrap();
        sheet.write_number(r, 1, f64::from(r)).unwrap();
        sheet.write_number(r, 2, -1.5).unwrap();
    }
    book.save_to_buffer().unwrap()
}
