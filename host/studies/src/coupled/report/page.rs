//! The page.

use super::{map, margins};
use crate::StudyText;
use crate::coupled::CoupledStudy;
use crepitus_pages::plot::page::{self, scrolling};
use maud::html;

const LAYOUT: &str = "body{max-width:64rem}.map,.margins{margin-top:1.8rem}\
.margins table{border-collapse:collapse}.margins th,.margins td{padding:.2rem .8rem .2rem 0;text-align:left}";

pub(super) fn html(study: &CoupledStudy, text: &StudyText) -> String {
    let body = html! {
        header {
            p.kicker { "Crepitus · where the device stays quiet on a leg" }
            h1 { (text.title) }
            p.description { (text.intro) }
        }
        main {
            section.map { (scrolling("Chart", &html! { (map::svg(study)) })) }
            (margins::table("The presets", "preset", &study.presets, |m| m.setting.preset.name))
            (margins::table("The paper’s joint with other effects", "with", &study.extras, |m| m.setting.extra.name))
            (page::tables(&text.tables))
        }
        (page::footer(&text.footer))
    };
    page::document(&text.title, LAYOUT, &map::INKS, &body)
}
