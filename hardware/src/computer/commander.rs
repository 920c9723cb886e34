//! What the joints are commanded at every servo step: a hold, a motion that was handed over, or streamed set-points,
//! and what is done when they are no longer renewed.

use armid::trajectory::QuinticStep;

use super::{JointLimits, Replacement, Spline};

/// How old the newest set-point may be while the arm moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watchdog {
    /// Then the arm is brought to rest, s.
    pub hold_s: f64,
    /// Then the motors are switched off, s.
    pub disable_s: f64,
}

impl Default for Watchdog {
    fn default() -> Self {
        Self { hold_s: 0.020, disable_s: 0.100 }
    }
}

/// How a motion that was handed over ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// At its end.
    Succeeded,
    /// Cancelled, and the arm is at rest.
    Cancelled,
    /// The motors were switched off.
    Aborted,
}

#[derive(Clone, Debug)]
enum Activity {
    Hold,
    Follow(Box<Follow>),
    Stream(Stream),
    Off(String),
}

#[derive(Clone, Debug)]
struct Follow {
    spline: Spline,
    start_s: f64,
    /// Where the arm was commanded to be, less where the motion begins: fades out over [`FADE_S`].
    offset: Vec<f64>,
    /// When it was cancelled, and how long coming to rest takes, s.
    brake: Option<(f64, f64)>,
    /// What takes its place, and when, s.
    next: Option<(Spline, f64)>,
}

#[derive(Clone, Debug)]
struct Stream {
    goal: Vec<f64>,
    arrived_s: f64,
    /// When the goal is due: set-points are joined by straight lines.
    due_s: f64,
    moving: bool,
}

/// Largest distance of a motion's first point from what is commanded now, rad (m).
const START_TOLERANCE: f64 = 0.05;
/// Time over which such a distance fades out, s.
const FADE_S: f64 = 0.5;
/// Longest time between two set-points that are still joined by a line, s.
const LONGEST_LINE_S: f64 = 0.010;
/// A joint that is commanded slower than this rests, rad/s (m/s).
const REST: f64 = 1e-4;

/// Decides the command of every servo step.
#[derive(Clone, Debug)]
pub struct Commander {
    limits: Vec<JointLimits>,
    watchdog: Watchdog,
    dt: f64,
    q: Vec<f64>,
    qd: Vec<f64>,
    doing: Activity,
    outcome: Option<Outcome>,
    began_s: Option<f64>,
    replacement: Replacement,
    start_tolerance: f64,
}

impl Commander {
    /// A commander that holds `q`, deciding every `dt` s.
    pub fn new(limits: Vec<JointLimits>, watchdog: Watchdog, dt: f64, q: &[f64]) -> Self {
        let qd = vec![0.0; q.len()];
        let (q, replacement) = (q.to_vec(), Replacement::default());
        Self {
            limits,
            watchdog,
            dt,
            q,
            qd,
            doing: Activity::Hold,
            outcome: None,
            began_s: None,
            replacement,
            start_tolerance: START_TOLERANCE,
        }
    }

    /// Treats a motion that comes while another is under way so.
    pub fn set_replacement(&mut self, replacement: Replacement) {
        self.replacement = replacement;
    }

    /// Joins a motion in its midst however far that is, as `joint_trajectory_controller` does.
    pub fn join_anywhere(&mut self) {
        self.start_tolerance = f64::INFINITY;
    }

    /// How it treats a motion that comes while another is under way.
    pub fn replacement(&self) -> Replacement {
        self.replacement
    }

    /// The watchdog of set-points.
    pub fn set_watchdog(&mut self, watchdog: Watchdog) {
        self.watchdog = watchdog;
    }

    /// The limits.
    pub fn limits(&self) -> &[JointLimits] {
        &self.limits
    }

    /// What is commanded, rad (m); n. Means nothing while the motors are off.
    pub fn command(&self) -> &[f64] {
        &self.q
    }

    /// Why the motors are off, where they are.
    pub fn off(&self) -> Option<&str> {
        match &self.doing {
            Activity::Off(reason) => Some(reason),
            _ => None,
        }
    }

    /// What is being done, in a word: `hold`, `follow`, `stream` or `off`.
    pub fn doing(&self) -> &'static str {
        match &self.doing {
            Activity::Hold => "hold",
            Activity::Follow(_) => "follow",
            Activity::Stream(_) => "stream",
            Activity::Off(_) => "off",
        }
    }

    /// When the first motion began, s of the robot's clock.
    pub fn began_s(&self) -> Option<f64> {
        self.began_s
    }

    /// How a motion that was handed over has ended, reported once.
    pub fn outcome(&mut self) -> Option<Outcome> {
        self.outcome.take()
    }

    /// Takes a motion that begins at `start_s` of the robot's clock, now `t`.
    ///
    /// # Errors
    /// Why it is refused.
    pub fn follow(&mut self, spline: Spline, start_s: f64, t: f64) -> Result<(), String> {
        if start_s + spline.duration_s() < t - self.dt {
            return Err(format!("it ended {:.3} s ago, expected an end to come", t - start_s - spline.duration_s()));
        }
        match &self.doing {
            Activity::Off(reason) => return Err(format!("the motors are off: {reason}")),
            Activity::Follow(_) => return self.replace(spline, start_s, t),
            Activity::Hold | Activity::Stream(_) => {}
        }
        if self.qd.iter().any(|qd| qd.abs() > REST) {
            return Err("the arm is not at rest".to_owned());
        }
        let spline = self.enter(spline, t - start_s)?;
        let mut first = vec![0.0; self.q.len()];
        spline.evaluate((t - start_s).max(0.0), &mut first, &mut vec![0.0; self.q.len()]);
        let offset = self.q.iter().zip(&first).map(|(q, first)| q - first).collect();
        self.doing = Activity::Follow(Box::new(Follow { spline, start_s, offset, brake: None, next: None }));
        self.outcome = None;
        Ok(())
    }

    /// The motion, entered at time `now` of its own: from where the joints are commanded to be, which must be close to it,
    /// or on the way to its first point.
    fn enter(&self, spline: Spline, now: f64) -> Result<Spline, String> {
        let first_s = spline.first().0;
        if first_s > now.max(0.0) {
            let entered = spline.entered(now.max(0.0), &self.q, &self.qd, &self.limits);
            return entered.map_err(|unfit| unfit.reason);
        }
        let mut q = vec![0.0; self.q.len()];
        spline.evaluate(now.max(0.0), &mut q, &mut vec![0.0; self.q.len()]);
        let tolerance = self.start_tolerance;
        match (0..q.len()).find(|&j| (q[j] - self.q[j]).abs() > tolerance) {
            None => Ok(spline),
            Some(j) => {
                let (name, found, expected) = (&self.limits[j].name, q[j], self.q[j]);
                Err(format!(
                    "joint \"{name}\": it is at {found:.4} now, expected {expected:.4} within {tolerance}, where the arm is"
                ))
            }
        }
    }

    /// Takes a motion while another is under way.
    fn replace(&mut self, spline: Spline, start_s: f64, t: f64) -> Result<(), String> {
        let later = start_s > t + self.dt;
        match self.replacement {
            Replacement::Refused => return Err("another motion is under way".to_owned()),
            Replacement::BothCancelled => {
                self.cancel(t);
                return Ok(());
            }
            Replacement::Deferred | Replacement::Spliced if later => {
                if let Activity::Follow(follow) = &mut self.doing {
                    follow.next = Some((spline, start_s));
                }
                return Ok(());
            }
            Replacement::Spliced => {
                // It ignores the stamp: what was to begin earlier begins now, with a way to its first point.
                let entered = spline.clone().entered(0.0, &self.q, &self.qd, &self.limits);
                return self.install(if spline.first().0 > 0.0 { entered.unwrap_or(spline) } else { spline }, t);
            }
            Replacement::AtOnce | Replacement::Deferred | Replacement::LateEnd => {}
        }
        let spline = self.enter(spline, t - start_s)?;
        self.install(spline, start_s)
    }

    fn install(&mut self, spline: Spline, start_s: f64) -> Result<(), String> {
        if let Activity::Follow(follow) = &mut self.doing {
            let same = (follow.start_s - start_s).abs() < 1e-9;
            let offset = if same { follow.offset.clone() } else { vec![0.0; self.q.len()] };
            **follow = Follow { spline, start_s, offset, brake: None, next: None };
            self.outcome = None;
        }
        Ok(())
    }

    /// Cancels what is being done: the arm comes to rest on the path it is on. Returns whether there was anything.
    pub fn cancel(&mut self, t: f64) -> bool {
        let span = stopping_time(&self.limits, &self.qd);
        match &mut self.doing {
            Activity::Follow(follow) => {
                follow.next = None;
                follow.brake.get_or_insert((t.max(follow.start_s), span));
                true
            }
            Activity::Stream(stream) => {
                // As if no set-point had come for too long.
                stream.arrived_s = stream.arrived_s.min(t - self.watchdog.hold_s - self.dt);
                stream.moving = false;
                true
            }
            Activity::Hold | Activity::Off(_) => false,
        }
    }

    /// Takes a streamed set-point. Returns whether it is followed: it must be finite and within the position limits,
    /// the motors on, and no motion under way.
    pub fn set_point(&mut self, goal: &[f64], t: f64) -> bool {
        let fits = goal.len() == self.q.len()
            && goal.iter().zip(&self.limits).all(|(q, joint)| *q >= joint.position.0 && *q <= joint.position.1);
        if !fits || matches!(self.doing, Activity::Off(_) | Activity::Follow(_)) {
            return false;
        }
        let before = match &self.doing {
            Activity::Stream(stream) => Some(stream),
            _ => None,
        };
        if before.is_none() && goal.iter().zip(&self.q).any(|(goal, q)| (goal - q).abs() > START_TOLERANCE) {
            return false;
        }
        let since = before.map_or(self.dt, |stream| t - stream.arrived_s).clamp(self.dt, LONGEST_LINE_S);
        let last = before.map_or(&self.q, |stream| &stream.goal);
        let moving = goal.iter().zip(last).any(|(goal, last)| (goal - last).abs() > REST * since);
        if moving {
            self.began_s.get_or_insert(t);
        }
        self.doing = Activity::Stream(Stream { goal: goal.to_vec(), arrived_s: t, due_s: t + since, moving });
        true
    }

    /// Switches the motors off, for good.
    pub fn switch_off(&mut self, reason: impl Into<String>) {
        if matches!(self.doing, Activity::Follow(_)) {
            self.outcome = Some(Outcome::Aborted);
        }
        if !matches!(self.doing, Activity::Off(_)) {
            self.doing = Activity::Off(reason.into());
            self.qd.fill(0.0);
        }
    }

    /// Decides the command for time `t` of the robot's clock, s.
    pub fn step(&mut self, t: f64) {
        let before = self.q.clone();
        match &mut self.doing {
            Activity::Off(_) => return,
            Activity::Hold => slow_down(&self.limits, self.dt, &mut self.q, &self.qd),
            Activity::Follow(follow) => {
                if t >= follow.start_s {
                    self.began_s.get_or_insert(t);
                }
                if let Some((spline, start_s)) = follow.next.take_if(|(_, start_s)| t >= *start_s) {
                    let offset = vec![0.0; self.q.len()];
                    **follow = Follow { spline, start_s, offset, brake: None, next: None };
                }
                if let Some(outcome) = follow.step(t, &mut self.q) {
                    self.outcome = Some(outcome);
                    self.doing = Activity::Hold;
                }
            }
            Activity::Stream(stream) => {
                let age = t - stream.arrived_s;
                if age > self.watchdog.disable_s && stream.moving {
                    let reason = format!("disabled: no set-point for {:.0} ms", 1e3 * self.watchdog.disable_s);
                    self.doing = Activity::Off(reason);
                    self.qd.fill(0.0);
                    return;
                }
                if age > self.watchdog.hold_s {
                    slow_down(&self.limits, self.dt, &mut self.q, &self.qd);
                    if !stream.moving && self.qd.iter().all(|qd| qd.abs() < REST) {
                        self.doing = Activity::Hold;
                    }
                } else {
                    stream.step(t, self.dt, &mut self.q);
                }
            }
        }
        for j in 0..self.q.len() {
            let joint = &self.limits[j];
            let most = joint.velocity * self.dt;
            let way = (self.q[j] - before[j]).clamp(-most, most);
            self.q[j] = (before[j] + way).clamp(joint.position.0, joint.position.1);
            self.qd[j] = (self.q[j] - before[j]) / self.dt;
        }
    }
}

impl Follow {
    fn step(&mut self, t: f64, q: &mut [f64]) -> Option<Outcome> {
        let now = t - self.start_s;
        let on_path = match self.brake {
            Some((from, span)) if t > from => {
                let u = (t - from).min(span);
                from - self.start_s + u - 0.5 * u * u / span
            }
            _ => now,
        };
        let mut qd = vec![0.0; q.len()];
        self.spline.evaluate(on_path.clamp(0.0, self.spline.duration_s()), q, &mut qd);
        let fade = 1.0 - QuinticStep::evaluate(on_path / FADE_S).value;
        for (q, offset) in q.iter_mut().zip(&self.offset) {
            *q += fade * offset;
        }
        match self.brake {
            Some((from, span)) if t >= from + span => Some(Outcome::Cancelled),
            None if now >= self.spline.duration_s() => Some(Outcome::Succeeded),
            _ => None,
        }
    }
}

impl Stream {
    fn step(&self, t: f64, dt: f64, q: &mut [f64]) {
        let left = self.due_s - t;
        let share = if left > dt { dt / left } else { 1.0 };
        for (q, goal) in q.iter_mut().zip(&self.goal) {
            *q += share * (goal - *q);
        }
    }
}

/// Moves on with a speed that falls at the acceleration limit.
fn slow_down(limits: &[JointLimits], dt: f64, q: &mut [f64], qd: &[f64]) {
    for (j, joint) in limits.iter().enumerate() {
        let speed = (qd[j].abs() - joint.acceleration * dt).max(0.0);
        q[j] += speed.copysign(qd[j]) * dt;
    }
}

/// Time in which every joint stops at half its acceleration limit, at least 50 ms.
fn stopping_time(limits: &[JointLimits], qd: &[f64]) -> f64 {
    limits.iter().zip(qd).map(|(joint, qd)| 2.0 * qd.abs() / joint.acceleration).fold(0.05, f64::max)
}

#[cfg(test)]
mod tests;
