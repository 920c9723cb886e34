//! The link and the robot controller across a real wire, on this machine alone.

use std::net::UdpSocket;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

use armid::conformance::chains::planar_2r;
use armid::experiment::{
    Arm, Ending, ExperimentPlan, Flow, RawSample, Recorder, Recording, Rest, SafeAction, Sensing, Servo, Sink,
    TripReport, record,
};
use armid::model::Robot;
use armid::observer::Unobserved;
use armid::seed::Seed;
use armid::trajectory::{FourierJoint, FourierTrajectory};

use super::{Endpoint, LinkError, LinkSettings, Mode, Ros2Arm, look};
use crate::computer::flywheels::{FlyWheels, nominal};
use crate::computer::{Fault, Replacement, RobotController, ServeOptions, Watchdog, serve};
use crate::guard::Machine;
use crate::message::{Float64MultiArray, Header, JointState, Text, Time};

fn plan(robot: &Robot) -> ExperimentPlan {
    let joints = robot.joints().iter().enumerate().map(|(j, joint)| FourierJoint {
        name: joint.name.clone(),
        a: vec![0.4, 0.2 - 0.3 * j as f64],
        b: vec![0.1, -0.2],
        q0: 0.3,
    });
    let trajectory = FourierTrajectory { period_s: 1.0, joints: joints.collect() };
    let plan = ExperimentPlan::new(trajectory);
    ExperimentPlan { rate_hz: 500.0, settle_s: 0.2, ramp_s: 0.5, discarded_periods: 0, periods: 2, ..plan }
}

/// A robot controller at work in this process, until it is dropped.
struct Robotics {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Robotics {
    fn start(settings: &LinkSettings, fault: Option<&str>) -> Self {
        Self::begin(settings, |controller| controller.with_fault(fault.map(|text| Fault::parse(text).unwrap())))
    }

    fn begin(
        settings: &LinkSettings,
        change: impl FnOnce(RobotController<FlyWheels>) -> RobotController<FlyWheels>,
    ) -> Self {
        let robot = planar_2r();
        let mut start = [0.0; 2];
        let plan = plan(&robot);
        let layout = plan.layout().unwrap();
        armid::experiment::Command::new(&plan, &layout).start(&mut start);
        // A machine that builds and tests at the same time is no robot controller: the watchdog is patient here.
        let watchdog = Watchdog { hold_s: 1.0, disable_s: 2.0 };
        let mut controller = RobotController::new(
            &robot,
            &nominal(),
            FlyWheels(start, [0.0; 2]),
            &Sensing::ideal(),
            Seed::new(1),
            0,
            500.0,
            1_000_000_000_000,
        )
        .unwrap()
        .with_watchdog(watchdog);
        controller = change(controller);
        let stop = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stop);
        let options = ServeOptions { link: settings.clone(), ..Default::default() };
        let thread = std::thread::spawn(move || {
            serve(&mut controller, &options, &mut |_| !asked.load(Ordering::Relaxed)).unwrap();
        });
        Self { stop, thread: Some(thread) }
    }
}

impl Drop for Robotics {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Settings with a domain that no other test has, in this process or beside it: who has a domain holds the port that stands
/// for it until the process ends.
fn settings(mode: Mode) -> LinkSettings {
    static HELD: Mutex<Vec<UdpSocket>> = Mutex::new(Vec::new());
    let first = std::process::id() % 120;
    let domains = (0..120).map(|k| 100 + ((first + k) % 120) as u16);
    let free = |domain: u16| Some((domain, UdpSocket::bind(("127.0.0.1", 20_000 + domain)).ok()?));
    let (domain, socket) = domains.into_iter().find_map(free).expect("fewer than 120 robots at a time");
    HELD.lock().unwrap().push(socket);
    LinkSettings { domain, mode, patience_s: 20.0, ..LinkSettings::default() }
}

fn performs_as_in_process(mode: Mode) {
    performs_as_in_process_with(mode, Replacement::default());
}

fn performs_as_in_process_with(mode: Mode, replacement: Replacement) {
    let robot = planar_2r();
    let plan = plan(&robot);
    let settings = settings(mode);
    let _controller = Robotics::begin(&settings, |controller| controller.with_replacement(replacement));
    let mut arm = Ros2Arm::connect(&settings, &robot, "text").unwrap();
    let reading = arm.reading().unwrap();
    assert!((reading.rate_hz - 500.0).abs() < 1e-6, "{reading:?}");
    assert!(reading.row.qd.iter().all(|qd| qd.abs() < 1e-9));
    let (recording, ending) = record(&mut arm, &plan).unwrap();
    assert_eq!(ending, Ending::Completed);
    assert_eq!(recording.len(), plan.layout().unwrap().samples());
    assert_eq!((recording.robot_text.as_str(), recording.periods()), ("text", 2));
    let found = arm.findings();
    assert!(found.lost == 0 && found.missing.is_empty() && found.clock_jumps == 0, "{found:?}");
    // The same experiment without a wire: the robot controller interpolates between points or set-points, and begins
    // with another past; the servo follows both within a few milliradians of each other.
    let mut servo = Servo::new(&robot, &nominal(), FlyWheels([0.0; 2], [0.0; 2])).unwrap();
    servo = servo.with_sensing(Sensing::ideal());
    let (expected, _) = record(&mut servo, &plan).unwrap();
    let far = recording.q.iter().zip(&expected.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // Set-points come a message late, on a machine that may be busy: 1 rad/s for some milliseconds.
    let bound = if mode == Mode::Stream { 0.05 } else { 1e-5 };
    assert!(far < bound, "{mode:?}: {far}");
}

#[test]
fn identity_a_motion_by_action_is_performed_as_without_a_wire() {
    performs_as_in_process(Mode::Trajectory);
}

#[test]
fn identity_a_motion_by_topic_is_performed_as_without_a_wire() {
    performs_as_in_process(Mode::Topic);
}

#[test]
fn identity_streamed_set_points_are_performed_as_without_a_wire() {
    performs_as_in_process(Mode::Stream);
}

/// What versions of `joint_trajectory_controller` do with a piece that takes the place of another, and the path is kept.
#[test]
fn identity_a_motion_in_pieces_is_performed_whatever_becomes_of_the_old_piece() {
    for replacement in [Replacement::Deferred, Replacement::LateEnd] {
        performs_as_in_process_with(Mode::Trajectory, replacement);
    }
}

#[test]
fn where_both_pieces_end_it_is_a_trip_and_the_arm_is_seen_at_rest() {
    let settings = settings(Mode::Trajectory);
    let trip = tripped(&settings, |controller| controller.with_replacement(Replacement::BothCancelled));
    assert_eq!(trip.trip, "robot-stopped", "{trip}");
    assert!(matches!(trip.rest, Rest::Confirmed { .. }), "{trip}");
}

#[test]
fn a_clock_that_jumps_back_is_a_trip_and_the_arm_is_seen_at_rest() {
    for mode in [Mode::Trajectory, Mode::Stream] {
        let trip = tripped(&settings(mode), with_fault("clock@motion+0.6"));
        assert!(trip.trip == "robot-stopped" && trip.reason.contains("clock jumped by -1.99"), "{trip}");
        assert!(matches!(trip.rest, Rest::Confirmed { .. }), "{trip}");
    }
}

#[test]
fn a_clock_that_is_stepped_or_runs_fast_is_a_trip_and_the_arm_is_seen_at_rest() {
    for (fault, mode) in [("clock:0.1", Mode::Trajectory), ("clock:0.1", Mode::Stream), ("rate:1.3", Mode::Trajectory)]
    {
        let trip = tripped(&settings(mode), move |controller| {
            controller.with_fault(Some(Fault::parse(&format!("{fault}@motion+0.6")).unwrap()))
        });
        assert!(trip.trip == "robot-stopped" && trip.reason.contains("the robot's clock advanced"), "{trip}");
        assert!(matches!(trip.rest, Rest::Confirmed { .. }), "{trip}");
    }
}

#[test]
fn a_clock_that_runs_fast_from_the_beginning_is_refused() {
    let settings = settings(Mode::Trajectory);
    let _controller = Robotics::start(&settings, Some("rate:1.3@0"));
    let refused = Ros2Arm::connect(&settings, &planar_2r(), "").err().expect("a refusal").to_string();
    assert!(refused.contains("the robot's clock advanced by"), "{refused}");
}

/// A goal that was under way to the robot controller when the arm was to stop comes 0.4 s late.
#[test]
fn a_goal_that_is_taken_after_the_cancel_moves_nothing_once_rest_is_confirmed() {
    for fault in ["late-execution:0.4@motion+0.1", "lost-goal:0.4@motion+0.1"] {
        let settings = settings(Mode::Trajectory);
        let _controller = Robotics::start(&settings, Some(fault));
        let robot = planar_2r();
        let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
        let mut sink = Until { recorder: Recorder::watched_by(&Unobserved), until: 0.3, flow: Flow::Stop };
        let ending = arm.perform(&plan(&robot), &mut sink).unwrap();
        assert!(matches!(ending, Ending::Stopped { rest: Rest::Confirmed { .. }, .. }), "{fault}: {ending:?}");
        let first = arm.reading().unwrap().row.q;
        std::thread::sleep(std::time::Duration::from_millis(800));
        let second = arm.reading().unwrap().row.q;
        assert!(first.iter().zip(&second).all(|(a, b)| (a - b).abs() < 1e-3), "{fault}: {first:?} {second:?}");
    }
}

#[test]
fn a_gripper_that_starts_in_the_midst_is_no_loss_of_states() {
    for mode in [Mode::Trajectory, Mode::Stream] {
        let settings = settings(mode);
        let _controller = Robotics::start(&settings, Some("gripper@motion+0.6"));
        let robot = planar_2r();
        let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
        assert_eq!(record(&mut arm, &plan(&robot)).unwrap().1, Ending::Completed);
    }
}

/// Another node that publishes joint states 50 times a second, until it is dropped.
struct Publishes(Arc<AtomicBool>, Option<JoinHandle<()>>);

impl Publishes {
    /// States of these joints, stamped by their number or not at all; `reliable` or best-effort. It takes set-points as well.
    fn start(settings: &LinkSettings, joints: &'static [&'static str], stamped: bool, reliable: bool) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let (asked, settings) = (Arc::clone(&stop), LinkSettings { reliable, ..settings.clone() });
        let thread = std::thread::spawn(move || {
            let mut endpoint = Endpoint::join(&settings, "publishes").unwrap();
            let topic = settings.full(&settings.joint_states);
            let states = endpoint.publisher(&topic, ("sensor_msgs", "JointState"), &settings.state_qos()).unwrap();
            let commands = settings.full(&settings.commands);
            let kind = ("std_msgs", "Float64MultiArray");
            let taken = endpoint.subscription::<Float64MultiArray>(&commands, kind, &settings.command_qos()).unwrap();
            for k in 0.. {
                let stamp = Time::from_ns(if stamped { k * 20_000_000 } else { 0 }).unwrap();
                let name: Vec<String> = joints.iter().map(|&joint| joint.to_owned()).collect();
                let (position, effort) = (vec![0.0; name.len()], vec![0.0; name.len()]);
                let header = Header { stamp, frame_id: String::new() };
                states.publish(JointState { header, name, position, velocity: Vec::new(), effort }).unwrap();
                std::thread::sleep(std::time::Duration::from_millis(20));
                if asked.load(Ordering::Relaxed) {
                    break;
                }
            }
            drop(taken);
        });
        Self(stop, Some(thread))
    }
}

impl Drop for Publishes {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
        if let Some(thread) = self.1.take() {
            let _ = thread.join();
        }
    }
}

#[test]
fn a_gripper_that_reports_its_own_joint_on_the_same_topic_is_no_second_robot() {
    let settings = settings(Mode::Trajectory);
    let _controller = Robotics::start(&settings, None);
    let _gripper = Publishes::start(&settings, &["gripper"], true, true);
    let robot = planar_2r();
    let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
    assert_eq!(record(&mut arm, &plan(&robot)).unwrap().1, Ending::Completed);
}

#[test]
fn stamps_that_stand_still_and_states_that_cannot_come_are_named() {
    let joints: &[&str] = &["shoulder", "elbow"];
    for (stamped, reliable, words) in
        [(false, true, "messages came, all stamped 0 s"), (true, false, "set reliable = false in [ros2]")]
    {
        let settings = LinkSettings { robot_state: String::new(), patience_s: 4.0, ..settings(Mode::Stream) };
        let _robot = Publishes::start(&settings, joints, stamped, reliable);
        let began = std::time::Instant::now();
        let refused = look(&settings, &planar_2r()).unwrap_err().to_string();
        assert!(refused.contains(words), "{refused}");
        assert!(began.elapsed().as_secs_f64() < 2.0 * settings.patience_s);
    }
}

/// Keeps samples until one is later than `until`, then answers with `flow`.
struct Until {
    recorder: Recorder<'static>,
    until: f64,
    flow: Flow,
}

impl Sink for Until {
    fn begin(&mut self, recording: &Recording) {
        self.recorder.begin(recording);
    }
    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        self.recorder.sample(sample);
        if sample.t < self.until { Flow::Continue } else { self.flow }
    }
}

#[test]
fn a_stop_brings_the_arm_to_rest_where_it_stays() {
    for mode in Mode::ALL {
        let settings = settings(mode);
        let _controller = Robotics::start(&settings, None);
        let robot = planar_2r();
        let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
        let mut sink = Until { recorder: Recorder::watched_by(&Unobserved), until: 1.0, flow: Flow::Stop };
        let ending = arm.perform(&plan(&robot), &mut sink).unwrap();
        assert!(matches!(ending, Ending::Stopped { t, .. } if (t - 1.0).abs() < 1e-9), "{ending:?}");
        assert!(matches!(ending, Ending::Stopped { rest: Rest::Confirmed { .. }, .. }), "{ending:?}");
        assert_eq!(sink.recorder.into_recording().unwrap().len(), 501);
        let first = arm.reading().unwrap().row.q;
        std::thread::sleep(std::time::Duration::from_millis(100));
        let second = arm.reading().unwrap().row.q;
        // The servo settles: it moves by less than a milliradian in a tenth of a second.
        assert!(first.iter().zip(&second).all(|(a, b)| (a - b).abs() < 1e-3), "{mode:?}: {first:?} {second:?}");
        let moved = first[0] - 0.3;
        assert!(moved.abs() < 1.0);
    }
}

/// Counts what is no part of the experiment, and answers with `flow` to what comes before it.
struct Aside {
    before: Vec<f64>,
    after: Vec<f64>,
    samples: usize,
    flow: Flow,
}

impl Sink for Aside {
    fn begin(&mut self, _: &Recording) {}
    fn sample(&mut self, _: &RawSample<'_>) -> Flow {
        self.samples += 1;
        Flow::Continue
    }
    fn unrecorded(&mut self, sample: &RawSample<'_>) -> Flow {
        if sample.t < 0.0 { &mut self.before } else { &mut self.after }.push(sample.t);
        self.flow
    }
}

#[test]
fn states_before_the_first_sample_and_after_the_last_are_heard_and_may_trip() {
    let settings = settings(Mode::Trajectory);
    let _controller = Robotics::start(&settings, None);
    let robot = planar_2r();
    let samples = plan(&robot).layout().unwrap().samples();
    let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
    let mut sink = Aside { before: Vec::new(), after: Vec::new(), samples: 0, flow: Flow::Continue };
    assert!(arm.perform(&plan(&robot), &mut sink).unwrap().is_complete());
    assert_eq!(sink.samples, samples);
    // Every state of the lead but those that came before the motion was handed over; then on to its end.
    let lead = (settings.lead_s * 500.0).ceil() as usize;
    assert!(sink.before.len() <= lead && sink.before.len() > lead / 2, "{}", sink.before.len());
    assert!(sink.before.is_sorted() && sink.after.is_sorted());
    assert!(sink.after.iter().all(|&t| t >= (samples - 1) as f64 / 500.0), "{:?}", sink.after);
    // The robot controller ends a motion a moment after its last sample, and takes no other one until then.
    std::thread::sleep(std::time::Duration::from_secs_f64(settings.lead_s + 0.5));
    // Who trips there has commanded nothing: the arm stays where it is.
    let stands = arm.reading().unwrap().row.q;
    let flow = Flow::Trip(SafeAction::Cancel);
    let mut sink = Aside { before: Vec::new(), after: Vec::new(), samples: 0, flow };
    let ending = arm.perform(&plan(&robot), &mut sink).unwrap();
    assert!(matches!(ending, Ending::Stopped { t, .. } if t < 0.0), "{ending:?}");
    assert_eq!((sink.before.len(), sink.samples), (1, 0));
    std::thread::sleep(std::time::Duration::from_secs_f64(settings.lead_s + 0.5));
    let after = arm.reading().unwrap().row.q;
    assert!(stands.iter().zip(&after).all(|(a, b)| (a - b).abs() < 1e-3), "{stands:?} {after:?}");
}

/// A stop in the lead need not wait for the motion that it prevents; only a topic, which never answers, shows by nothing
/// but the motion that does not come that the hold was taken.
#[test]
fn a_stop_before_the_motion_begins_does_not_wait_for_its_beginning() {
    for mode in [Mode::Trajectory, Mode::Stream] {
        let mut settings = settings(mode);
        settings.lead_s = 20.0;
        let _controller = Robotics::start(&settings, None);
        let robot = planar_2r();
        let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
        let before = arm.reading().unwrap().row;
        let mut sink = Aside { before: Vec::new(), after: Vec::new(), samples: 0, flow: Flow::Stop };
        let ending = arm.perform(&plan(&robot), &mut sink).unwrap();
        assert!(matches!(ending, Ending::Stopped { t, rest: Rest::Confirmed { .. }, .. } if t < 0.0), "{ending:?}");
        assert_eq!((sink.before.len(), sink.samples), (1, 0), "{mode:?}");
        let after = arm.reading().unwrap().row;
        let took_s = (after.stamp_ns - before.stamp_ns) as f64 * 1e-9;
        assert!(took_s < 0.5 * settings.lead_s, "{mode:?}: {took_s} s by the robot's clock");
        assert!(before.q.iter().zip(&after.q).all(|(a, b)| (a - b).abs() < 1e-3), "{mode:?}: {after:?}");
    }
}

#[test]
fn an_emergency_stop_ends_the_experiment_with_its_reason_and_every_sample_before() {
    let settings = settings(Mode::Trajectory);
    let _controller = Robotics::start(&settings, Some("estop@motion+0.5"));
    let robot = planar_2r();
    let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
    let (recording, ending) = record(&mut arm, &plan(&robot)).unwrap();
    let Ending::Tripped { trip, .. } = ending else { panic!("{ending:?}") };
    assert!(trip.reason.contains("estop"), "{trip}");
    assert!(recording.len() > 100 && recording.len() < plan(&robot).layout().unwrap().samples());
    let refused = record(&mut arm, &plan(&robot)).unwrap_err().to_string();
    assert!(refused.contains("estop"), "{refused}");
}

/// Performs the plan on a robot controller and says how it was tripped.
fn tripped(
    settings: &LinkSettings,
    change: impl FnOnce(RobotController<FlyWheels>) -> RobotController<FlyWheels>,
) -> TripReport {
    let _controller = Robotics::begin(settings, change);
    let robot = planar_2r();
    let mut arm = Ros2Arm::connect(settings, &robot, "").unwrap();
    match record(&mut arm, &plan(&robot)).unwrap().1 {
        Ending::Tripped { trip, .. } => *trip,
        other => panic!("{other:?}, expected a trip"),
    }
}

fn with_fault(text: &'static str) -> impl FnOnce(RobotController<FlyWheels>) -> RobotController<FlyWheels> {
    move |controller| controller.with_fault(Some(Fault::parse(text).unwrap()))
}

#[test]
fn an_answer_that_does_not_come_is_a_trip_and_the_arm_is_seen_at_rest() {
    let settings = settings(Mode::Trajectory);
    for (fault, name) in [("late-answer@motion+0.6", "no-acceptance"), ("lost-result@motion+0.6", "no-result")] {
        let trip = tripped(&settings, with_fault(fault));
        assert_eq!(trip.trip, name, "{trip}");
        assert!(matches!(trip.rest, Rest::Confirmed { .. }), "{trip}");
    }
}

#[test]
fn a_robot_that_replaces_no_motion_under_way_stops_by_itself_and_takes_whole_motions() {
    let mut settings = settings(Mode::Trajectory);
    let refuse = |controller: RobotController<FlyWheels>| controller.with_replacement(Replacement::Refused);
    let trip = tripped(&settings, refuse);
    assert!(trip.trip == "robot-stopped" && trip.reason.contains("horizon_s = 0"), "{trip}");
    assert!(matches!(trip.rest, Rest::Confirmed { .. }), "{trip}");
    settings.horizon_s = 0.0;
    let _controller = Robotics::begin(&settings, refuse);
    let robot = planar_2r();
    let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
    assert_eq!(record(&mut arm, &plan(&robot)).unwrap().1, Ending::Completed);
}

/// A sink that fails in an unexpected way.
struct Fails(usize);

impl Sink for Fails {
    fn begin(&mut self, _: &Recording) {}
    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        assert!(sample.index < self.0, "out of order");
        Flow::Continue
    }
}

#[test]
fn a_panic_of_our_own_is_a_trip_and_the_arm_is_seen_at_rest() {
    let settings = settings(Mode::Trajectory);
    let _controller = Robotics::start(&settings, None);
    let robot = planar_2r();
    let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
    let ending = arm.perform(&plan(&robot), &mut Fails(400)).unwrap();
    let Ending::Tripped { trip, .. } = ending else { panic!("{ending:?}") };
    assert!(trip.trip == "panic" && trip.reason.contains("out of order"), "{trip}");
    assert!(matches!(trip.rest, Rest::Confirmed { .. }), "{trip}");
}

#[test]
fn nobody_who_answers_is_not_confirmed() {
    let settings = settings(Mode::Trajectory);
    let trip = {
        let controller = Robotics::start(&settings, Some("freeze@motion+0.6"));
        let robot = planar_2r();
        let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
        // The machine of a test may stand still for as long before the robot does: that is not the silence.
        let mut sink = Silent { after_s: 0.55, line_s: 0.2, t: f64::NEG_INFINITY };
        let ending = arm.perform(&plan(&robot), &mut sink).unwrap();
        drop(controller);
        let Ending::Stopped { rest, .. } = ending else { panic!("{ending:?}") };
        rest
    };
    assert!(matches!(&trip, Rest::NotConfirmed { reason } if reason.contains("no joint state")), "{trip:?}");
}

/// A sink that stops where no sample has come for longer than `line_s` once the motion is `after_s` old, s.
struct Silent {
    after_s: f64,
    line_s: f64,
    /// Time of the newest sample, s.
    t: f64,
}

impl Sink for Silent {
    fn begin(&mut self, _: &Recording) {}
    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        self.t = sample.t;
        Flow::Continue
    }
    fn idle(&mut self, age_s: f64) -> Flow {
        if self.t >= self.after_s && age_s > self.line_s { Flow::Trip(SafeAction::Cancel) } else { Flow::Continue }
    }
}

#[test]
fn where_the_end_was_asked_for_before_the_motion_nothing_goes_out() {
    for mode in Mode::ALL {
        let settings = settings(mode);
        let _controller = Robotics::start(&settings, None);
        let robot = planar_2r();
        let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
        let before = arm.reading().unwrap();
        let mut sink = Silent { after_s: f64::NEG_INFINITY, line_s: -1.0, t: f64::NEG_INFINITY };
        let ending = arm.perform(&plan(&robot), &mut sink).unwrap();
        assert!(matches!(ending, Ending::Stopped { rest: Rest::Confirmed { .. }, .. }), "{mode:?}: {ending:?}");
        let after = arm.reading().unwrap();
        assert_eq!((after.state, after.row.q), (before.state, before.row.q), "{mode:?}");
    }
}

#[test]
fn a_second_robot_in_the_domain_is_refused() {
    let settings = settings(Mode::Trajectory);
    let _controller = [Robotics::start(&settings, None), Robotics::start(&settings, None)];
    let refused = Ros2Arm::connect(&settings, &planar_2r(), "").err().expect("a refusal").to_string();
    assert!(refused.contains("interference") && refused.contains("expected 1"), "{refused}");
}

#[test]
fn a_second_robot_that_comes_later_is_a_trip() {
    let settings = settings(Mode::Trajectory);
    let _controller = Robotics::start(&settings, None);
    let robot = planar_2r();
    let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
    let _second = Robotics::start(&settings, None);
    let mut slow = plan(&robot);
    slow.periods = 30;
    let (_, ending) = record(&mut arm, &slow).unwrap();
    let Ending::Tripped { trip, .. } = ending else { panic!("{ending:?}") };
    // Whichever is noticed first: who is there, or states of two clocks.
    assert!(trip.trip == "interference" || trip.reason.contains("clock"), "{trip}");
}

#[test]
fn a_word_that_was_said_once_and_kept_is_heard() {
    let settings = LinkSettings { robot_state: "kept_state".to_owned(), ..settings(Mode::Trajectory) };
    // The controller publishes nothing on that topic: another node did, before this subscription.
    let _controller = Robotics::start(&LinkSettings { robot_state: String::new(), ..settings.clone() }, None);
    let mut endpoint = Endpoint::join(&settings, "latch").unwrap();
    let qos = settings.command_qos().durability(ros2_client::qos::Durability::TransientLocal);
    let kept = endpoint.publisher("/kept_state", ("std_msgs", "String"), &qos).unwrap();
    kept.publish(Text { data: "drives off; not referenced".to_owned() }).unwrap();
    let robot = planar_2r();
    let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
    let survey = arm.survey().unwrap();
    assert_eq!((survey.homed, survey.ready), (None, Some(false)));
    assert_eq!(survey.state.as_deref(), Some("drives off; not referenced"));
}

#[test]
fn disable_is_offered_only_where_somebody_listens() {
    let settings = settings(Mode::Trajectory);
    let deaf = LinkSettings { robot_request: String::new(), ..settings.clone() };
    for (served, offered) in [(&settings, true), (&deaf, false)] {
        let _controller = Robotics::start(served, None);
        let arm = Ros2Arm::connect(&settings, &planar_2r(), "").unwrap();
        assert_eq!(arm.can_disable(), offered);
    }
}

#[test]
fn an_arm_that_is_not_homed_is_told_before_it_moves() {
    let settings = settings(Mode::Trajectory);
    let _controller = Robotics::begin(&settings, |controller| controller.with_homed(false));
    let robot = planar_2r();
    let mut arm = Ros2Arm::connect(&settings, &robot, "").unwrap();
    // Its word comes on a topic of its own, some time after the first joint states.
    let survey = arm.survey().unwrap();
    assert_eq!((survey.homed, survey.ready), (None, Some(false)));
    assert_eq!(survey.state.as_deref(), Some("enabled not homed hold"));
    // A request nevertheless is refused.
    let refused = record(&mut arm, &plan(&robot)).unwrap_err().to_string();
    assert!(refused.contains("not homed"), "{refused}");
}

#[test]
fn nobody_there_is_told_with_the_domain() {
    let settings = LinkSettings { patience_s: 0.3, ..settings(Mode::Trajectory) };
    let message = look(&settings, &planar_2r()).unwrap_err().to_string();
    assert!(message.contains("/joint_states") && message.contains(&settings.domain.to_string()), "{message}");
    let settings = LinkSettings { patience_s: 600.0, ..settings };
    assert_eq!(Ros2Arm::find(&settings, &planar_2r(), "", || true).err(), Some(LinkError::Interrupted));
}
