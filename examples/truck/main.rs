//! Writes the decks of `models/truck-shell` and `models/truck-beam` from one parameter file.
//!
//!     cargo run --example truck -- models/truck.toml models [--size MM] [--without-ballast]
//!
//! The parameter file and the README next to each deck describe the physics. Axes: x to the rear, y to the right, z up from the ground; tonne, mm,
//! second, newton.

mod beam_frame;
mod deck;
mod parameters;
mod running_gear;
mod shell_frame;

use deck::DeckText;
use parameters::Truck;
use std::{env, error::Error, fs, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = env::args().skip(1);
    let (mut files, mut size, mut with_ballast) = (Vec::new(), None, true);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--size" => {
                size = Some(
                    words
                        .next()
                        .ok_or("--size needs a length in mm")?
                        .parse::<f64>()?,
                )
            }
            "--without-ballast" => with_ballast = false,
            _ => files.push(word),
        }
    }
    let [parameter_file, folder] = files.as_slice() else {
        return Err("usage: truck PARAMETERS.toml FOLDER [--size MM] [--without-ballast]".into());
    };
    let mut truck: Truck = toml::from_str(&fs::read_to_string(parameter_file)?)?;
    truck.mesh.size = size.unwrap_or(truck.mesh.size);
    if !with_ballast {
        truck.compensating.clear();
    }
    for (name, build) in [
        (
            "truck-shell",
            shell_frame::build as fn(&Truck, &mut DeckText) -> running_gear::Frame,
        ),
        ("truck-beam", beam_frame::build),
    ] {
        let mut deck = DeckText::new();
        let frame = build(&truck, &mut deck);
        running_gear::add(&truck, &frame, &mut deck);
        let folder = Path::new(folder).join(name);
        fs::create_dir_all(&folder)?;
        fs::write(folder.join("truck.bdf"), deck.finish(name))?;
    }
    Ok(())
}
