//! Results from another version of the deck: ids agree, but strain differs.

use super::folder;
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// Version of the deck: a free strip of ten plates, each 20 mm long.
#[derive(Clone, Copy)]
struct Strip {
    length: f64,
    thickness: f64,
    modulus: f64,
    /// Shells with the reverse grid order.
    turned: &'static [u32],
}

const STRIP: Strip = Strip {
    length: 20.0,
    thickness: 2.0,
    modulus: 210_000.0,
    turned: &[],
};

impl Strip {
    fn deck(self) -> String {
        let mut deck = "SOL 101\nCEND\nBEGIN BULK\n".to_owned();
        for i in 0..11_u32 {
            for j in 0..2_u32 {
                let x = self.length * f64::from(i);
                let _ = writeln!(deck, "GRID,{},,{x:.1},{}.,0.", 1 + i + 100 * j, 20 * j);
            }
        }
        for i in 1..11 {
            let mut corners = [i, i + 1, i + 101, i + 100];
            if self.turned.contains(&i) {
                corners.reverse();
            }
            let [a, b, c, d] = corners;
            let _ = writeln!(deck, "CQUAD4,{i},1,{a},{b},{c},{d}");
        }
        let (t, e) = (self.thickness, self.modulus);
        let _ = write!(
            deck,
            "PSHELL,1,1,{t:.2},1,,1\nMAT1,1,{e:.1},,.3,7.85-9\nENDDATA\n"
        );
        deck
    }
}

fn run(dir: &Path, command: &str, results: &str) -> Value {
    let mut text = format!(
        "units = \"mm-t-s\"\n[model]\ndeck = \"strip.bdf\"\nmesh_error = false\n{results}\n"
    );
    for (load, grid) in [("left", 1), ("middle", 6)] {
        let _ = writeln!(
            text,
            "[[load]]\nname = \"{load}\"\ngrid = {grid}\ncomponent = \"FZ\"\nexpected = 10.0"
        );
    }
    for (gauge, element) in [("a", 3), ("b", 7)] {
        let _ = writeln!(
            text,
            "[[gauge]]\nname = \"{gauge}\"\nelement = {element}\nsurface = \"top\"\ndirection = [1, 0, 0]"
        );
    }
    text += "[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 1.0\n";
    let job = dir.join(format!("{command}.toml"));
    std::fs::write(&job, text).unwrap();
    let out = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args([command, &job.display().to_string(), "--json"])
        .output()
        .unwrap();
    serde_json::from_slice(&out.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&out.stderr)))
}

/// Returns severity and message of the finding, if the results of `other` are used with the deck of [`STRIP`].
fn contradiction(name: &str, other: Strip, command: &str) -> Option<(String, String)> {
    let dir = folder(&format!("other_results_{name}_{command}"));
    std::fs::write(dir.join("strain.csv"), "run,a,b\nR1,1,2\n").unwrap();
    std::fs::write(dir.join("strip.bdf"), other.deck()).unwrap();
    run(&dir, "solve", "");
    std::fs::write(dir.join("strip.bdf"), STRIP.deck()).unwrap();
    let result = run(&dir, command, "results = [\"solve.out/results.op2\"]");
    let findings = result["findings"].as_array().unwrap();
    let mut found = findings
        .iter()
        .filter(|f| f["code"] == "strain-contradicts-deck");
    let text = |f: &Value, key: &str| f[key].as_str().unwrap().to_owned();
    found
        .next()
        .map(|f| (text(f, "severity"), text(f, "message")))
}

#[test]
fn results_of_the_same_deck_agree() {
    for command in ["recover", "sensitivity", "place"] {
        assert_eq!(contradiction("same", STRIP, command), None);
    }
    // A thickness that is 2 % larger is within the tolerance of sheet metal. Bending strain falls by 4 %.
    let other = Strip {
        thickness: 2.04,
        ..STRIP
    };
    assert_eq!(contradiction("tolerance", other, "recover"), None);
}

#[test]
fn results_of_another_material_thickness_length_or_normal_are_errors() {
    let named = |name: &str, other: Strip, words: &str| {
        for command in ["recover", "sensitivity", "place"] {
            let found = contradiction(name, other, command);
            let (severity, message) = found.unwrap_or_else(|| panic!("{name}, {command}"));
            assert_eq!(severity, "error", "{name}, {command}: {message}");
            assert!(message.contains(words), "{name}, {command}: {message}");
        }
    };
    // Strain is inversely proportional to the modulus and, in bending, to the square of the thickness.
    let stiff = Strip {
        modulus: 630_000.0,
        ..STRIP
    };
    named("stiff", stiff, "is 0.333 times as large");
    let thick = Strip {
        thickness: 4.0,
        ..STRIP
    };
    named("thick", thick, "is 0.250 times as large");
    let turned = Strip {
        turned: &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10],
        ..STRIP
    };
    // At each surface, bending strain changes its sign, but shear does not.
    named("turned", turned, "`middle` by 1");
    // Only one shell, the one below gauge `a`.
    let one = Strip {
        turned: &[3],
        ..STRIP
    };
    named(
        "one",
        one,
        "The strain in the results has another sign or direction than the built-in solver computes on this deck, in elements 3",
    );
    let long = Strip {
        length: 50.0,
        ..STRIP
    };
    named("long", long, "times as large");
}
