//! Noise by gauge and its correlation, as stated in the job.

use super::folder;
use serde_json::Value;
use std::process::Command;

/// Runs `recover` for one load and two gauges that read 3 and 5 microstrain. S is 1 microstrain per N.
fn two_gauges(name: &str, noise: &str) -> (i32, String, Value) {
    let dir = folder(name);
    let write = |name: &str, text: &str| std::fs::write(dir.join(name), text).unwrap();
    write("S.csv", "gauge,F\nG1,1\nG2,1\n");
    write("strain.csv", "run,G1,G2\nR0,3,5\n");
    let job = format!(
        "units = \"m-kg-s\"\n[sensitivity]\nfile = \"S.csv\"\nper = {{ force = \"N\" }}\n\
         [measured]\nstrain = \"strain.csv\"\n{noise}\n[[load]]\nname = \"F\"\n"
    );
    write("job.toml", &job);
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(["recover", &dir.join("job.toml").display().to_string()])
        .output()
        .unwrap();
    let result = std::fs::read(dir.join("job.out/result.json")).unwrap_or_default();
    (
        done.status.code().unwrap_or(-1),
        String::from_utf8_lossy(&done.stderr).into_owned(),
        serde_json::from_slice(&result).unwrap_or(Value::Null),
    )
}

/// Generalised least squares in closed form, with variances .25 and 1 and covariance .1: weights .9 / 1.05 and .15 /
/// 1.05, variance .24 / 1.05.
#[test]
fn loads_are_weighted_by_the_stated_noise() {
    let noise = "noise_microstrain = { G1 = 0.5, G2 = 1.0 }\nnoise_correlation = 0.2";
    let (code, printed, result) = two_gauges("noise_stated", noise);
    assert_ne!(code, 2, "{printed}");
    let load = &result["loads"][0];
    let [value, sigma] = ["value", "sigma"].map(|k| load[k].as_f64().unwrap());
    assert!(
        (value - (0.9 * 3.0 + 0.15 * 5.0) / 1.05).abs() < 1e-9,
        "{value}"
    );
    // The readings differ by 2. The variance of the difference is 1.05, which agrees with the stated noise.
    assert!((sigma - (0.24_f64 / 1.05).sqrt()).abs() < 1e-9, "{sigma}");
}

#[test]
fn noise_of_some_gauges_alone_is_a_fault() {
    let (code, printed, _) = two_gauges("noise_of_one", "noise_microstrain = { G1 = 0.5 }");
    assert_eq!(code, 2);
    assert!(printed.contains("`G2` is not stated"), "{printed}");
    let (code, printed, _) = two_gauges(
        "noise_negative",
        "noise_microstrain = { G1 = 0.5, G2 = -1 }",
    );
    assert_eq!(code, 2);
    assert!(printed.contains("expected a number above 0"), "{printed}");
    let (code, printed, _) = two_gauges(
        "noise_unknown",
        "noise_microstrain = { G1 = 0.5, G2 = 1, G22 = 1 }",
    );
    assert_eq!(code, 2);
    assert!(
        printed.contains("`G22` is not a gauge of the job"),
        "{printed}"
    );
}
