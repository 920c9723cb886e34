//! What the robot measures, and how well: encoder counts, motor currents.
//!
//! ```text
//! counts = round(± q_motor / step + φ + noise)      q̂_motor = ± counts · step          φ ∈ [−½, ½) once per run
//! î = clamp(round((i + noise) / lsb)) · lsb         i = mean over the servo period around the sample
//! ```
//! `φ` is where the zero of the joint lies between two lines of the encoder: homing finds the line, not the zero, so
//! every run looks at the same motion through a grid that lies elsewhere. The current's converter integrates over one
//! servo period centred on the sample; the current steps at the sample, so it reads the mean of the two steps, which
//! is the current at that instant to second order.

use super::effects::{ActualSensors, Eccentricity, Memory, Spikes};
use super::normals::Normals;
use crate::lanes::Lane;
use crate::model::Robot;
use crate::seed::{RunNoise, Stream};

/// Which imperfections the sensors have.
///
/// ```
/// # use armid_measurement as armid;
/// use armid::experiment::Sensing;
/// assert!(Sensing::default().encoders && !Sensing::ideal().encoders);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sensing {
    /// Encoders resolve whole counts.
    pub encoders: bool,
    /// White noise of the motor positions ahead of the encoder, standard deviation in rad (m) at the joint, n; empty
    /// for none.
    pub position_noise: Vec<f64>,
    /// Current sensors have the white noise of the robot's drives.
    pub current_noise: bool,
    /// Current converters have the range and the bits of the robot's drives.
    pub converters: bool,
    /// Steps of encoders at the links, behind the transmissions, rad (m): 0 for exact ones, `None` where there are none.
    pub link_step: Option<f64>,
    /// The controller reports the voltage at the motors' terminals, where the robot file has every motor's circuit.
    pub voltage: bool,
}

impl Default for Sensing {
    /// What the robot file says; no position noise.
    fn default() -> Self {
        Self { current_noise: true, converters: true, ..Self::noise_free() }
    }
}

impl Sensing {
    /// Sensors that read exactly what is there.
    pub fn ideal() -> Self {
        Self { encoders: false, ..Self::noise_free() }
    }

    /// Encoders that count, currents without fault.
    pub const fn noise_free() -> Self {
        Self {
            encoders: true,
            position_noise: Vec::new(),
            current_noise: false,
            converters: false,
            link_step: None,
            voltage: false,
        }
    }
}

/// The sensors of one run.
#[derive(Clone, Debug)]
pub(super) struct Sensors {
    encoders: Vec<Encoder>,
    meters: Vec<Ammeter>,
    /// Noise of each voltage, V; empty where none is reported.
    volts: Vec<f64>,
    voltage_normals: Normals,
    /// Step of the encoders at the links, rad (m), and where each zero lies between two of its lines; `None` where there are none.
    links: Option<(f64, Vec<f64>)>,
    position_normals: Normals,
    current_normals: Normals,
    spike_stream: Stream,
    /// 1, or −1 in a run with opposite noise.
    sign: f64,
    /// How late the sample is taken, in servo steps, −½ to ½.
    pub(super) late: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Encoder {
    /// Counts per unit of the joint, with the encoder's sign; 0 where it does not quantise.
    counts: f64,
    step: f64,
    /// Where the zero of the joint lies between two lines, −½ to ½.
    pub(super) grid: f64,
    pub(super) noise: f64,
    eccentricity: Option<Eccentricity>,
}

#[derive(Clone, Debug)]
pub(super) struct Ammeter {
    pub(super) noise: f64,
    /// Smallest step, A; 0 where it does not quantise.
    lsb: f64,
    per_lsb: f64,
    codes: f64,
    offset: f64,
    memory: Option<Memory>,
    spikes: Option<Spikes>,
}

impl Encoder {
    /// What it says where the motor is at `q` and the zero of the joint at `grid`, of a run or of several.
    #[inline(always)]
    pub(super) fn reading<V: Lane>(&self, q: V, grid: V) -> V {
        if self.counts == 0.0 { q } else { (q * q.splat(self.counts) + grid).nearest() * q.splat(self.step) }
    }
}

impl Ammeter {
    /// What the converter makes of a current, A, of a run or of several.
    #[inline(always)]
    pub(super) fn converted<V: Lane>(&self, current: V) -> V {
        if self.lsb == 0.0 {
            return current;
        }
        let (least, most) = (current.splat(-self.codes), current.splat(self.codes - 1.0));
        let code = (current * current.splat(self.per_lsb)).nearest();
        let code = code.less(least, least, code);
        most.less(code, most, code) * current.splat(self.lsb)
    }
}

impl Sensors {
    pub(super) fn new(robot: &Robot, sensing: &Sensing, run: RunNoise) -> Self {
        use rand::RngExt;
        let mut grid_stream = run.stream("encoder grid");
        let encoders = robot.joints().iter().enumerate().map(|(i, joint)| {
            let grid = run.sign() * (grid_stream.random::<f64>() - 0.5);
            let step = joint.drive.encoder_step(joint.kind == crate::model::JointKind::Revolute);
            let counts = if sensing.encoders && step > 0.0 { joint.drive.encoder_sign / step } else { 0.0 };
            let noise = sensing.position_noise.get(i).copied().unwrap_or(0.0);
            Encoder { counts, step: step * joint.drive.encoder_sign, grid, noise, eccentricity: None }
        });
        let meters = robot.joints().iter().map(|joint| {
            let lsb = if sensing.converters { joint.drive.adc_step() } else { 0.0 };
            Ammeter {
                noise: if sensing.current_noise { joint.drive.current_noise } else { 0.0 },
                lsb,
                per_lsb: if lsb > 0.0 { 1.0 / lsb } else { 0.0 },
                codes: if joint.drive.adc_bits > 0 { f64::from(1_u32 << (joint.drive.adc_bits - 1)) } else { 0.0 },
                offset: 0.0,
                memory: None,
                spikes: None,
            }
        });
        let drives = || robot.joints().iter().map(|joint| &joint.drive);
        let volts = if sensing.voltage && drives().all(|drive| drive.circuit.is_some()) {
            drives().map(|drive| if sensing.current_noise { drive.voltage_noise } else { 0.0 }).collect()
        } else {
            Vec::new()
        };
        let mut link_stream = run.stream("link encoder grid");
        let mut between_lines = || run.sign() * (link_stream.random::<f64>() - 0.5);
        let links = sensing.link_step.map(|step| (step, robot.joints().iter().map(|_| between_lines()).collect()));
        Self {
            encoders: encoders.collect(),
            meters: meters.collect(),
            volts,
            links,
            voltage_normals: Normals::new(run.stream("voltage noise")),
            position_normals: Normals::new(run.stream("position noise")),
            current_normals: Normals::new(run.stream("current noise")),
            spike_stream: run.stream("torque spikes"),
            sign: run.sign(),
            late: 0.0,
        }
    }

    /// Returns these sensors with the faults of those of an arm.
    pub(super) fn with_effects(mut self, actual: &ActualSensors) -> Self {
        for (i, encoder) in self.encoders.iter_mut().enumerate() {
            encoder.counts /= actual.encoder_step;
            encoder.step *= actual.encoder_step;
            encoder.eccentricity = Some(actual.eccentricity[i]);
            // Independent noises add by their squares.
            encoder.noise = libm::hypot(encoder.noise, actual.position_noise[i]);
        }
        for (i, meter) in self.meters.iter_mut().enumerate() {
            meter.lsb *= actual.converter_step;
            meter.per_lsb /= actual.converter_step;
            meter.codes = (meter.codes / actual.converter_step).floor();
            meter.offset = actual.offset[i];
            meter.memory = Some(actual.memory);
            meter.noise = libm::hypot(meter.noise, actual.current_noise[i]);
            meter.spikes = Some(actual.spikes[i]);
        }
        self
    }

    /// Motor coordinates as the encoders give them, rad (m), n.
    pub(super) fn positions(&mut self, q_motor: &[f64], measured: &mut [f64]) {
        for (i, encoder) in self.encoders.iter().enumerate() {
            let mut q = q_motor[i];
            if let Some(eccentricity) = &encoder.eccentricity {
                q += eccentricity.error(q);
            }
            if encoder.noise > 0.0 {
                q += encoder.noise * self.sign * self.position_normals.draw();
            }
            measured[i] = encoder.reading(q, encoder.grid);
        }
    }

    /// Whether links have encoders of their own.
    pub(super) fn has_links(&self) -> bool {
        self.links.is_some()
    }

    /// Joint coordinates as the encoders at the links give them, rad (m), n.
    pub(super) fn links(&self, q: &[f64], measured: &mut [f64]) {
        let Some((step, grids)) = &self.links else { return };
        for ((measured, q), grid) in measured.iter_mut().zip(q).zip(grids) {
            *measured = if *step > 0.0 { (q / step + grid).nearest() * step } else { *q };
        }
    }

    /// Motor currents as the sensors give them, A, n; `before` and `after` are held on either side of the sample.
    pub(super) fn currents(&mut self, before: &[f64], after: &[f64], measured: &mut [f64]) {
        // All noise first, so that no call stands between the arithmetic of one joint and the next.
        self.current_noise(|i, noise| measured[i] = noise);
        for (((meter, measured), before), after) in self.meters.iter().zip(measured).zip(before).zip(after) {
            let mut current = 0.5 * (before + after);
            if self.late != 0.0 {
                current += self.late * (after - before);
            }
            if meter.noise > 0.0 {
                current += *measured;
            }
            if meter.offset != 0.0 {
                current += meter.offset;
            }
            if let Some(spike) = meter.spikes.and_then(|spikes| spikes.reading(&mut self.spike_stream, self.sign)) {
                current = spike;
            }
            *measured = meter.converted(current);
        }
    }

    /// Encoders of the motors and ammeters alone, without faults: what [`super::joint_loops::JointLoops`] has in lanes.
    pub(super) fn plain(&self) -> Option<(&[Encoder], &[Ammeter])> {
        let sound = self.encoders.iter().all(|encoder| encoder.eccentricity.is_none())
            && self.meters.iter().all(|meter| meter.memory.is_none() && meter.spikes.is_none() && meter.offset == 0.0);
        (sound && self.links.is_none() && self.volts.is_empty()).then_some((&self.encoders, &self.meters))
    }

    /// What the noise of positions and of currents is drawn from, and its sign.
    pub(super) fn normals(&mut self) -> ([&mut Normals; 2], f64) {
        ([&mut self.position_normals, &mut self.current_normals], self.sign)
    }

    /// The next noise of each current, A, of ammeters that have some.
    pub(super) fn current_noise(&mut self, mut hand: impl FnMut(usize, f64)) {
        for (i, meter) in self.meters.iter_mut().enumerate().filter(|(_, meter)| meter.noise > 0.0) {
            let white = self.sign * self.current_normals.draw();
            hand(i, meter.noise * meter.memory.as_mut().map_or(white, |memory| memory.next(white)));
        }
    }

    /// Whether voltages are reported.
    pub(super) fn has_voltage(&self) -> bool {
        !self.volts.is_empty()
    }

    /// Terminal voltages as the controller reports them, V, n.
    pub(super) fn voltages(&mut self, measured: &mut [f64]) {
        for (value, &noise) in measured.iter_mut().zip(&self.volts) {
            if noise > 0.0 {
                *value += noise * self.sign * self.voltage_normals.draw();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{ActualArm, EffectKind, Effects, hinges};
    use crate::seed::Seed;

    #[test]
    fn analytic_encoder_error_is_within_a_step_and_its_grid_differs_from_run_to_run() {
        let robot = hinges::single();
        let step = robot.joints()[0].drive.encoder_step(true);
        let read = |run: u64, q: f64| {
            let mut out = [0.0];
            Sensors::new(&robot, &Sensing::default(), Seed::new(1).of_run(run)).positions(&[q], &mut out);
            out[0]
        };
        for run in 0..20 {
            for k in 0..100 {
                let q = -1.0 + 0.02 * f64::from(k) + 1e-7 * f64::from(k * k);
                let counts = read(run, q) / step;
                // Half a step of rounding and half a step of the grid's offset.
                assert!((read(run, q) - q).abs() <= step * 1.000_001);
                assert!((counts - counts.round()).abs() < 1e-9);
            }
        }
        assert!((0..20).any(|run| (read(run, 0.4 * step) - read(0, 0.4 * step)).abs() > 0.5 * step));
    }

    /// `î = (½ − ε/Δ) i_before + (½ + ε/Δ) i_after`, late by ε of a step Δ.
    #[test]
    fn analytic_a_late_sample_has_more_of_the_current_after_it() {
        let mut sensors = Sensors::new(&hinges::single(), &Sensing::ideal(), Seed::new(1).of_run(0));
        for (late, expected) in [(0.25, 1.75), (-0.25, 1.25), (0.5, 2.0)] {
            sensors.late = late;
            let mut out = [0.0];
            sensors.currents(&[1.0], &[2.0], &mut out);
            assert_eq!(out, [expected]);
        }
    }

    #[test]
    fn analytic_a_coarser_encoder_reads_the_same_position_in_larger_steps() {
        let robot = hinges::single();
        let step = robot.joints()[0].drive.encoder_step(true);
        let effects = Effects::none().with_effect(EffectKind::EncoderStep, 50.0);
        let actual = ActualArm::new(&effects, &robot, &hinges::parameters(1)).sensors(1000.0);
        let mut sensors = Sensors::new(&robot, &Sensing::noise_free(), Seed::new(1).of_run(0)).with_effects(&actual);
        let mut read: Vec<f64> = (0..400)
            .map(|k| {
                let (q, mut out) = (0.5 + step * f64::from(k), [0.0]);
                sensors.positions(&[q], &mut out);
                // Half a step of rounding and half a step of the grid's offset.
                assert!((out[0] - q).abs() <= 50.0 * step * 1.000_001, "{q}: {}", out[0]);
                out[0]
            })
            .collect();
        read.dedup();
        let apart = |pair: &[f64]| (pair[1] - pair[0]) / step;
        assert!(read.windows(2).all(|pair| (apart(pair) - 50.0).abs() < 1e-6), "{read:?}");
        // 400 steps of the fine encoder.
        assert!((8..=9).contains(&read.len()), "{}", read.len());
    }

    #[test]
    fn analytic_converter_rounds_and_clips() {
        let robot = hinges::single();
        let drive = &robot.joints()[0].drive;
        let sensing = Sensing { current_noise: false, ..Sensing::default() };
        let mut sensors = Sensors::new(&robot, &sensing, Seed::new(1).of_run(0));
        let mut out = [0.0];
        sensors.currents(&[1.0], &[1.2], &mut out);
        assert!((out[0] - 1.1).abs() <= 0.5 * drive.adc_step() * (1.0 + 1e-12));
        sensors.currents(&[100.0], &[100.0], &mut out);
        assert!((out[0] - (drive.adc_range - drive.adc_step())).abs() < 1e-12);
    }

    #[test]
    fn analytic_current_noise_has_the_drive_s_standard_deviation() {
        let robot = hinges::single();
        let sensing = Sensing { converters: false, ..Sensing::default() };
        let mut sensors = Sensors::new(&robot, &sensing, Seed::new(3).of_run(0));
        let mut out = [0.0];
        let count = 20_000;
        let sum: f64 = (0..count)
            .map(|_| {
                sensors.currents(&[0.5], &[0.5], &mut out);
                (out[0] - 0.5) * (out[0] - 0.5)
            })
            .sum();
        let ratio = (sum / f64::from(count)).sqrt() / robot.joints()[0].drive.current_noise;
        // χ² with 20 000 degrees of freedom: the ratio's standard deviation is 0.5 %; 4 of them.
        assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    }

    #[test]
    fn identity_opposite_noise_is_the_noise_with_the_other_sign() {
        let robot = hinges::single();
        let sensing = Sensing { converters: false, position_noise: vec![1e-4], ..Sensing::default() };
        let run = Seed::new(3).of_run(7);
        let read = |run: RunNoise| {
            let mut sensors = Sensors::new(&robot, &sensing, run);
            let grid = sensors.encoders[0].grid;
            let (mut q, mut current) = ([0.0], [0.0]);
            sensors.encoders[0].counts = 0.0;
            sensors.positions(&[0.3], &mut q);
            sensors.currents(&[0.5], &[0.5], &mut current);
            [grid, q[0] - 0.3, current[0] - 0.5]
        };
        for (a, b) in read(run).into_iter().zip(read(run.opposite())) {
            assert!(a != 0.0 && (a + b).abs() < 1e-15, "{a} {b}");
        }
    }
}
