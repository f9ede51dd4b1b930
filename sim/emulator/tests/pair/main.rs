//! Both images together, over USB.

use crepitus_emulator::firmware::{Program, image_for_test};
use crepitus_emulator::{Mcu, Pair};
use crepitus_scene::{Overrides, Scene};
use std::path::Path;

#[test]
fn enumerates() {
    let drive = image_for_test(Program::Drive).unwrap();
    let comms = image_for_test(Program::Comms).unwrap();
    let text = include_str!("../drive_image/examination.toml");
    let scene = Scene::parse(Path::new("x.toml"), text, &Overrides::default()).expect("a scene");
    let mut pair = Pair::new(&drive, &comms, &scene);
    let begin = std::time::Instant::now();
    let r = pair.plug_in();
    println!("{:?} at {} {:?}", r, pair.now(), begin.elapsed());
    println!("{:?}", pair.boards().comms().mcu().not_modelled());
    println!("{:x?} {:x?}", pair.boards().comms().mcu().program_counter(), pair.boards().comms().resets());
    println!("{:x?}", [0x0800_8000, 0x0800_c000, 0x4002_3c0c, 0x4002_3c10].map(|a| pair.boards().comms().mcu().peek(a)));
    r.unwrap();
    println!("{:?}", pair.host().unwrap().device());
    let map = std::sync::Arc::new(std::sync::Mutex::new(Default::default())); if std::env::var_os("PROF").is_some() { pair.boards_mut().comms_mut().prof = Some(map.clone()); }
    let c0 = [pair.boards().mcu().cycles(), pair.boards().comms().mcu().cycles()];
    let begin = std::time::Instant::now();
    for _ in 0..2_000 { pair.tick(); }
    println!("a second took {:?}; traffic {:?}", begin.elapsed(), pair.traffic());
    let c1 = [pair.boards().mcu().cycles(), pair.boards().comms().mcu().cycles()];
    for ((e,pc),c) in map.lock().unwrap().iter() { eprintln!("P {e} {pc:x} {c}"); }
    println!("cycles {} {}", c1[0]-c0[0], c1[1]-c0[1]);
    println!("{:?} {:?}", pair.boards().errors(), pair.boards().resets());
}
