//! View of the monitor: its content and its drawing.

use crate::measures::shown;
use crepitus_client::Accounting;
use crepitus_client::connection::device_text;
use crepitus_knee::Examination;
use crepitus_knee::examination::Measure;
use crepitus_panel::live::{Aim, Bin, Marks, Pace, STATES, Verdict};
use crepitus_plant::Extremes;
use crepitus_protocol::State;
use crepitus_protocol::host::Status;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style, Stylize};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::canvas::{Canvas, Line as Stroke};
use ratatui::widgets::{Block, Paragraph, Wrap};
use std::collections::VecDeque;

/// Time that is shown, s.
const SHOWN_S: f64 = 10.0;

/// Messages that are shown.
const MESSAGES: usize = 3;

/// A mark on the time line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    pub(super) number: usize,
    pub(super) time_s: f64,
}

/// Accounting of samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    produced: u64,
    received: u64,
    dropped: u64,
    lost: u64,
}

impl Counts {
    pub(super) fn of(accounting: &Accounting) -> Self {
        Self {
            produced: accounting.produced(),
            received: accounting.received(),
            dropped: accounting.dropped_by_device(),
            lost: accounting.lost_on_line(),
        }
    }
}

/// Content that is shown.
#[derive(Debug, Default)]
pub(super) struct View {
    device: String,
    bins: VecDeque<Bin>,
    bin_s: f64,
    /// End of the newest bin.
    end_s: f64,
    pub(super) status: Option<Status>,
    pub(super) holder: Option<String>,
    pub(super) counts: Option<Counts>,
    pub(super) examination: Examination,
    /// Whether a simulated examiner moves the leg.
    pub(super) is_simulated: bool,
    pub(super) marks: Vec<Mark>,
    messages: VecDeque<String>,
}

impl View {
    pub(super) fn new(device: String) -> Self {
        Self {
            device,
            ..Self::default()
        }
    }

    /// Adds bins, of which the first has this number.
    pub(super) fn extend(&mut self, first: u64, bin_s: f64, bins: Vec<Bin>) {
        if bins.is_empty() {
            return;
        }
        self.bin_s = bin_s;
        #[expect(clippy::cast_precision_loss, reason = "years of bins")]
        let end = (first + bins.len() as u64) as f64;
        self.end_s = end * bin_s;
        self.bins.extend(bins);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "some thousand bins"
        )]
        let most = (SHOWN_S / bin_s) as usize;
        let surplus = self.bins.len().saturating_sub(most);
        self.bins.drain(..surplus);
    }

    /// Sets a mark now.
    pub(super) fn mark(&mut self) {
        self.marks.push(Mark {
            number: self.marks.len() + 1,
            time_s: self.end_s,
        });
    }

    /// Shows a message.
    pub(super) fn tell(&mut self, text: &str) {
        if self.messages.len() >= MESSAGES {
            self.messages.pop_front();
        }
        self.messages.push_back(text.to_owned());
    }

    /// Draws all of it.
    pub(super) fn draw(&self, frame: &mut Frame<'_>, pace: Option<&Pace>) {
        let faults = self.faults();
        let warnings = u16::try_from(faults.len() + self.messages.len()).unwrap_or(0);
        let [head, numbers, measures, charts, warned, help] = Layout::vertical([
            Constraint::Length(1),
            Constraint::Length(2),
            Constraint::Length(2),
            Constraint::Min(6),
            Constraint::Length(warnings * 2),
            Constraint::Length(2),
        ])
        .areas(frame.area());
        frame.render_widget(self.head(), head);
        frame.render_widget(
            Paragraph::new(vec![self.numbers(), self.judged(pace)]),
            numbers,
        );
        let measured = Paragraph::new(self.measured()).wrap(Wrap { trim: true });
        frame.render_widget(measured, measures);
        let [torque, speed, angle] = Layout::vertical([Constraint::Fill(1); 3]).areas(charts);
        let band = pace.and_then(|pace| match pace.target().aim {
            Aim::Speed {
                low_deg_per_s,
                high_deg_per_s,
            } => Some((low_deg_per_s, high_deg_per_s)),
            Aim::Metronome { .. } => None,
        });
        let degrees = f64::from(180.0_f32 / std::f32::consts::PI);
        self.chart(frame, torque, "torque, N·m", |bin| bin.torque_nm, 1.0, None);
        self.chart(
            frame,
            speed,
            "speed, °/s",
            |bin| bin.speed_rad_s,
            degrees,
            band,
        );
        self.chart(frame, angle, "angle, °", |bin| bin.angle_rad, degrees, None);
        let lines = faults.into_iter().chain(self.messages.iter().cloned());
        let lines: Vec<_> = lines.map(|text| Line::from(text).fg(Color::Red)).collect();
        frame.render_widget(Paragraph::new(lines).wrap(Wrap { trim: true }), warned);
        frame.render_widget(Paragraph::new(vec![self.counted(), keys()]), help);
    }

    fn head(&self) -> Line<'_> {
        let state = self.status.map(|status| status.state);
        let colour = match state {
            Some(State::Armed) => Color::Green,
            Some(State::Faulted) => Color::Red,
            _ => Color::Yellow,
        };
        let style = Style::new().fg(colour).add_modifier(Modifier::BOLD);
        let mut spans = vec![
            Span::styled(
                state.map_or("connecting", State::name).to_uppercase(),
                style,
            ),
            Span::raw(format!("  {}", self.device)),
        ];
        if let Some(holder) = &self.holder {
            spans.push(Span::raw(format!("  armed by {holder}")));
        }
        Line::from(spans)
    }

    fn numbers(&self) -> Line<'_> {
        let Some(bin) = self.bins.back().filter(|bin| bin.marks.0 & Marks::GAP == 0) else {
            return Line::from("no samples");
        };
        // As text, so that the states need no colour.
        let mut states: Vec<_> = (STATES.iter().zip(0_u32..))
            .filter(|(_, place)| bin.states >> place & 1 == 1)
            .map(|(state, _)| format!("{} {}", state.effect, state.phase))
            .collect();
        for (mark, name) in [
            (Marks::SLIP, "slip"),
            (Marks::LIMITED, "limited"),
            (Marks::SETTLING, "settling"),
        ] {
            if bin.marks.0 & mark != 0 {
                states.push(name.to_owned());
            }
        }
        let middle = |of: Extremes<f32>| f64::from(f32::midpoint(of.low, of.high));
        Line::from(format!(
            "{:7.1} °  {:7.0} °/s  {:+7.3} N·m   {}",
            middle(bin.angle_rad).to_degrees(),
            middle(bin.speed_rad_s).to_degrees(),
            bin.torque_nm.high,
            states.join(", ")
        ))
        .bold()
    }

    /// Measures of the examination, as far as there are any.
    fn measured(&self) -> String {
        let measures = Measure::ALL.into_iter().filter_map(|measure| {
            let value = self.examination.measure(measure)?;
            Some(format!(
                "{} {}",
                measure.name(),
                shown(measure.spec(), value)
            ))
        });
        measures.collect::<Vec<_>>().join("   ")
    }

    fn judged(&self, pace: Option<&Pace>) -> Line<'static> {
        let Some(pace) = pace else {
            return Line::from("no target: t chooses one");
        };
        if self.is_simulated {
            let name = pace.target().name;
            let text = format!("target {name}: not judged, a simulated examiner moves the leg");
            return Line::from(text);
        }
        let (word, colour) = match pace.verdict() {
            Verdict::Rest => ("at rest", Color::Gray),
            Verdict::Slow => ("too slow", Color::Yellow),
            Verdict::Right => ("right", Color::Green),
            Verdict::Fast => ("too fast", Color::Red),
        };
        let score = pace.score();
        let scored = match score.score {
            Some(percent) => format!("score {percent:.0} of 100 in {} strokes", score.strokes),
            None if pace.is_scoring() => "scoring".to_owned(),
            None => "r begins a score".to_owned(),
        };
        let target = format!("target {}: ", pace.target().name);
        Line::from(vec![
            Span::raw(target),
            Span::styled(word, Style::new().fg(colour).bold()),
            Span::raw(format!("   {scored}")),
        ])
    }

    fn counted(&self) -> Line<'_> {
        let Counts {
            produced,
            received,
            dropped,
            lost,
        } = self.counts.unwrap_or_default();
        Line::from(format!(
            "{produced} produced = {received} received + {dropped} dropped + {lost} lost   {} marks",
            self.marks.len()
        ))
    }

    fn faults(&self) -> Vec<String> {
        let status = self.status.as_ref();
        status.map(device_text::faults).unwrap_or_default()
    }

    /// Lowest to highest of each bin, over the last seconds.
    fn chart(
        &self,
        frame: &mut Frame<'_>,
        area: Rect,
        title: &str,
        of: impl Fn(&Bin) -> Extremes<f32>,
        scale: f64,
        band: Option<(f64, Option<f64>)>,
    ) {
        let spans: Vec<_> = self.bins.iter().map(of).collect();
        let mut all = Extremes {
            low: 0.0,
            high: 0.0,
        };
        for span in &spans {
            all.join(*span);
        }
        let margin = (f64::from(all.high - all.low) * 0.05).max(0.01);
        let low = (f64::from(all.low) - margin) * scale;
        let high = (f64::from(all.high) + margin) * scale;
        let end_s = self.end_s;
        let heading = format!("{title}  {low:.1} to {high:.1}");
        let marks = self.marks.iter().map(|mark| mark.time_s);
        let marks: Vec<_> = marks.filter(|time_s| *time_s > end_s - SHOWN_S).collect();
        let canvas = Canvas::default()
            .block(Block::bordered().title(heading))
            .marker(Marker::Braille)
            .x_bounds([end_s - SHOWN_S, end_s])
            .y_bounds([low, high])
            .paint(move |context| {
                let level = |y: f64, color| Stroke {
                    x1: end_s - SHOWN_S,
                    y1: y,
                    x2: end_s,
                    y2: y,
                    color,
                };
                context.draw(&level(0.0, Color::DarkGray));
                if let Some((from, to)) = band {
                    for edge in [Some(from), to].into_iter().flatten() {
                        context.draw(&level(edge, Color::Green));
                        context.draw(&level(-edge, Color::Green));
                    }
                }
                for x in &marks {
                    context.draw(&Stroke {
                        x1: *x,
                        y1: low,
                        x2: *x,
                        y2: high,
                        color: Color::Magenta,
                    });
                }
                let mut x = end_s;
                for span in spans.iter().rev() {
                    x -= self.bin_s;
                    if span.is_empty() {
                        continue;
                    }
                    context.draw(&Stroke {
                        x1: x,
                        y1: f64::from(span.low) * scale,
                        x2: x,
                        y2: f64::from(span.high) * scale,
                        color: Color::Cyan,
                    });
                }
            });
        frame.render_widget(canvas, area);
    }
}

fn keys() -> Line<'static> {
    Line::from(vec![
        Span::styled(
            " s/Esc STOP ",
            Style::new().fg(Color::White).bg(Color::Red).bold(),
        ),
        Span::raw("  d disarm  m mark  t target  r score  q quit"),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_panel::live::{Envelope, Target};
    use crepitus_recording::Row;
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    fn drawn(view: &View, pace: Option<&Pace>, width: u16, height: u16) -> String {
        let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
        terminal.draw(|frame| view.draw(frame, pace)).unwrap();
        let buffer = terminal.backend().buffer();
        let line = |y| {
            (0..width)
                .map(|x| buffer[(x, y)].symbol())
                .collect::<String>()
        };
        (0..height).map(line).collect::<Vec<_>>().join("\n")
    }

    fn examined(seconds: f64) -> View {
        let mut view = View::new("knee".to_owned());
        let mut envelope = Envelope::new(100);
        let ticks = (0..).map(|tick| f64::from(tick) * 5e-5);
        for time_s in ticks.take_while(|time_s| *time_s < seconds) {
            envelope.take(&Row {
                time_s,
                angle_rad: 0.5,
                omega_rad_s: 1.0,
                torque_nm: 0.25,
                ..Row::default()
            });
        }
        let (first, bins) = envelope.complete();
        view.extend(first, envelope.bin_s(), bins);
        view
    }

    #[test]
    fn it_shows_numbers_states_and_counters() {
        let mut view = examined(2.0);
        view.status = Some(Status {
            state: State::Armed,
            ..Status::default()
        });
        view.counts = Some(Counts {
            produced: 40_000,
            received: 39_980,
            dropped: 20,
            lost: 0,
        });
        view.mark();
        let pace = Pace::new(Target::find("medium").unwrap());
        let text = drawn(&view, Some(&pace), 100, 30);
        for expected in [
            "ARMED  knee",
            "28.6 °",
            "57 °/s",
            "+0.250 N·m",
            "target medium: at rest",
            "40000 produced = 39980 received + 20 dropped + 0 lost   1 marks",
            "s/Esc STOP",
            "torque, N·m",
        ] {
            assert!(text.contains(expected), "{expected}:\n{text}");
        }
        assert_eq!(
            view.marks,
            [Mark {
                number: 1,
                time_s: 1.995
            }]
        );
    }

    #[test]
    fn it_shows_what_was_measured_and_judges_no_simulated_examiner() {
        let mut view = examined(0.1);
        for tick in 0..60_000 {
            let time_s = f64::from(tick) * 5e-5;
            let angle_rad = 0.6 - 0.5 * time_s.cos();
            let omega_rad_s = 0.5 * time_s.sin();
            (view.examination).take(time_s, angle_rad, omega_rad_s, 0.0);
        }
        let pace = Pace::new(Target::find("medium").unwrap());
        let text = drawn(&view, Some(&pace), 100, 30);
        for expected in ["range 57°", "peak-speed 29 °/s", "target medium: at rest"] {
            assert!(text.contains(expected), "{expected}:\n{text}");
        }
        view.is_simulated = true;
        let text = drawn(&view, Some(&pace), 100, 30);
        assert!(text.contains("medium: not judged"), "{text}");
    }

    #[test]
    fn a_fault_is_shown_with_its_remedy() {
        let mut view = examined(0.1);
        view.status = Some(Status {
            state: State::Faulted,
            drive_fault: 5,
            ..Status::default()
        });
        let text = drawn(&view, None, 120, 30);
        assert!(
            text.contains("FAULTED") && text.contains("overspeed (fault 5"),
            "{text}"
        );
    }

    #[test]
    fn ten_seconds_are_kept_and_any_size_is_drawn() {
        let view = examined(12.0);
        assert_eq!(view.bins.len(), 2_000);
        for (width, height) in [(1, 1), (20, 5), (80, 24), (300, 80)] {
            drawn(&view, None, width, height);
        }
        drawn(&View::new(String::new()), None, 80, 24);
    }
}
