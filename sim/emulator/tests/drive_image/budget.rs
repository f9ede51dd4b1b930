//! What a tick may cost: with crepitus and a ringing bone, under torque.

use crate::host::{Host, image};
use crepitus_emulator::Time;
use crepitus_emulator::mcu::{Step, Watch};
use crepitus_scene::{Overrides, Scene};
use std::collections::BTreeMap;
use std::path::Path;

#[derive(Default)]
struct Profile(
    BTreeMap<(u16, u32), (u64, u64)>,
    Vec<u64>,
    Option<Time>,
    BTreeMap<u16, Run>,
    Vec<u16>,
);
#[derive(Default, Clone)]
struct Run {
    now: u64,
    map: BTreeMap<u32, (u64, u64)>,
    worst: u64,
    worst_map: BTreeMap<u32, (u64, u64)>,
}

impl Watch for Profile {
    fn step(&mut self, step: &Step) {
        let e = self.0.entry((step.exception, step.pc)).or_default();
        e.0 += 1;
        e.1 += u64::from(step.cycles);
        let depth = step.active as usize;
        if depth > self.4.len() {
            self.4.push(step.exception);
        }
        if let Some(e) = self.4.last() {
            let r = self.3.entry(*e).or_default();
            r.now += u64::from(step.cycles);
            let q = r.map.entry(step.pc).or_default();
            q.0 += 1;
            q.1 += u64::from(step.cycles);
        }
        while self.4.len() > depth || (depth > 0 && *self.4.last().unwrap() != step.exception) {
            let e = self.4.pop().unwrap();
            let r = self.3.entry(e).or_default();
            if r.now > r.worst {
                r.worst = r.now;
                r.worst_map = r.map.clone();
            }
            r.now = 0;
            r.map.clear();
            if self.4.len() < depth {
                self.4.push(step.exception);
            }
        }
        let start = *self.2.get_or_insert(step.at);
        let tick = ((step.at - start).units() / 16_800) as usize;
        if self.1.len() <= tick {
            self.1.resize(tick + 1, 0);
        }
        if step.active > 0 {
            self.1[tick] += u64::from(step.cycles);
        }
    }
}

#[test]
fn profile() {
    let Some(image) = image() else { return };
    let text = include_str!("examination.toml").to_owned() + "[effects.bone-shaping]\n";
    let scene = Scene::parse(Path::new("examination.toml"), &text, &Overrides::default()).unwrap();
    let mut host = Host::new(&image, &scene);
    host.arm();
    host.run_until_torque();
    let mut profile = Profile::default();
    host.board.watch(4000, &mut profile);
    let mut out = String::new();
    for ((e, pc), (n, c)) in &profile.0 {
        out += &format!("{e} {pc:#x} {n} {c}\n");
    }
    std::fs::write("/tmp/p/profile.txt", out).unwrap();
    let mut out = String::new();
    for (e, r) in &profile.3 {
        for (pc, (n, c)) in &r.worst_map {
            out += &format!("{e} {pc:#x} {} {}\n", n * 4000, c * 4000);
        }
    }
    std::fs::write("/tmp/p/worst.txt", out).unwrap();
    let mut loads = profile.1.clone();
    loads.sort();
    println!(
        "mean {} median {} worst {:?}",
        loads.iter().sum::<u64>() / loads.len() as u64,
        loads[loads.len() / 2],
        &loads[loads.len() - 5..]
    );
}
