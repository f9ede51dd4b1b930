//! Orders of pages: each is checked when its turn comes, not when it was queued.

use super::torque_end::Cause;
use super::{DeviceThread, POLL};
use crate::control::{Holder, Page};
use crate::request::{Request, Right};
use crate::shared::{Order, Outcome};
use crate::tokens::Role;
use crepitus_client::{Client, Transport};
use serde_json::Value;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Longest time in the queue of an order that [expires](Request::expires): the device keeps this
/// thread busy for less, while it answers.
const LONGEST_QUEUED: Duration = Duration::from_secs(5);

/// Most orders of a turn: so many in its time are a flood of stops, of which the first has ended torque.
const MOST_ORDERS: u32 = 1_000;

impl<T: Transport> DeviceThread<'_, T> {
    /// Executes what pages have ordered, for no longer than a poll waits: however much they order, the page is
    /// supervised, and the device has its turn. A stop goes first, also one that comes meanwhile, and does not wait for
    /// the next turn.
    pub(super) fn take_orders(&mut self) {
        let mut is_unstored = false;
        let begun = Instant::now();
        for nth in 0..MOST_ORDERS {
            let is_over = nth > 0 && begun.elapsed() >= POLL;
            let Some(order) = self.next_order(is_over) else {
                return;
            };
            if matches!(
                order.request,
                Request::Experiments | Request::ExperimentResults
            ) {
                self.look_at_study(order);
                continue;
            }
            let outcome = self.check(&order).and_then(|()| {
                let Order { page, role, .. } = order;
                match order.request {
                    Request::Take => self.give_control(page),
                    Request::Release => self.end_control(page),
                    Request::Stop => {
                        self.torque_ends(Cause::Stop(role));
                        self.done(Client::stop)
                    }
                    Request::Disarm => {
                        self.torque_ends(Cause::Disarm);
                        self.done(Client::disarm)
                    }
                    Request::Join { name, key } => self.join(page, &name, key.as_deref()),
                    Request::Answer {
                        trial,
                        disorder,
                        level,
                        confidence,
                    } => {
                        is_unstored = true;
                        self.answer_own(page, trial, &disorder, level.as_deref(), confidence)
                    }
                    request => self.execute(request),
                }
            });
            self.status_is_due = true;
            if std::mem::take(&mut is_unstored) && outcome.is_ok() {
                self.unstored.push(order.reply);
                continue;
            }
            // The page may be gone.
            let _ = order.reply.send(outcome);
        }
    }

    /// The order to execute next; once the turn is over, only a stop.
    fn next_order(&mut self, is_over: bool) -> Option<Order> {
        self.waiting.extend(self.inbox.try_iter());
        let mut waiting = self.waiting.iter();
        match waiting.position(|order| order.request == Request::Stop) {
            None if is_over => None,
            stop => self.waiting.remove(stop.unwrap_or(0)),
        }
    }

    /// Rejects an order of a page that has lost control since it was queued, one to arm from before
    /// a stop, and one that has waited for too long.
    fn check(&self, order: &Order) -> Result<(), String> {
        let Order { request, page, .. } = order;
        let right = request.right();
        if right == Right::Run && order.role == Role::Remote {
            // Its page answers for the torque.
            if !matches!(self.shared.control.holder(), Holder::Page(_)) {
                return Err("no page has control: take control on the teacher's page".to_owned());
            }
        } else if matches!(right, Right::Control | Right::Run)
            && !self.shared.control.is_held_by(*page)
        {
            return Err("another page has control: take control first".to_owned());
        }
        if *request == Request::Arm && order.stops != self.shared.stops.load(Ordering::Relaxed) {
            return Err(
                "STOP was pressed meanwhile: look at the device, then turn the motor on again"
                    .to_owned(),
            );
        }
        let waited = order.queued_at.elapsed();
        if request.expires() && waited > LONGEST_QUEUED {
            return Err(format!(
                "the device kept the program busy for {:.1} s, so the request was not carried \
                 out: try again",
                waited.as_secs_f64()
            ));
        }
        if self.is_lost && request.needs_device() {
            return Err("the device is not connected: check the cable, then try again".to_owned());
        }
        Ok(())
    }

    /// Gives control to a page; the arming by another page is not inherited. The other page has
    /// lost control when the request was queued, so nothing of it is executed in between.
    fn give_control(&mut self, page: Page) -> Outcome {
        let control = &self.shared.control;
        if control.is_held_by(page) {
            return Ok(Value::Null);
        }
        control.withdraw_for(page);
        // Without a connection there is no torque.
        if !self.is_lost && (self.client.is_armed() || control.holder() == Holder::Passing) {
            self.torque_ends(Cause::TakeOver);
            self.done(Client::disarm)?;
        }
        self.shared.watchdog.begin();
        self.shared.control.give(page);
        Ok(Value::Null)
    }

    /// Ends control of a page, and torque if no page has control then.
    fn end_control(&mut self, page: Page) -> Outcome {
        // Given since the page has left.
        self.shared.control.release(page);
        if self.class.left(page) {
            self.publish_class();
        }
        if self.shared.control.holder() != Holder::Nobody || !self.client.is_armed() || self.is_lost
        {
            return Ok(Value::Null);
        }
        self.torque_ends(Cause::PageLeft);
        self.done(Client::disarm)
    }

    /// Ends torque that no page is responsible for any more.
    pub(super) fn supervise_page(&mut self) {
        if !self.client.is_armed() {
            return;
        }
        let cause = match self.shared.control.holder() {
            Holder::Nobody => Cause::PageLeft,
            Holder::Passing => Cause::TakeOver,
            Holder::Page(_) if self.shared.watchdog.has_expired() => Cause::Watchdog,
            Holder::Page(_) => return,
        };
        let why = match cause {
            Cause::TakeOver => "another page takes control: the motor is off",
            Cause::PageLeft => "the controlling page has gone: the motor is off",
            _ => "the controlling page has not answered for 200 ms: the motor is off",
        };
        self.torque_ends(cause);
        self.message = Some(match self.client.disarm() {
            Ok(()) => why.to_owned(),
            Err(error) => format!("{why}; {error}"),
        });
        self.status_is_due = true;
    }
}
