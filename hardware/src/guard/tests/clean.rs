//! Runs without a fault do not trip.

use armid::experiment::Arm;
use proptest::prelude::*;

use super::stage::{Count, Deed, Stage, plan, robot};
use crate::guard::{GuardSettings, Guarded, Mode};

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn no_clean_run_trips(
        part in 0.05..1.0_f64,
        rate_hz in prop_oneof![Just(500.0), Just(1000.0)],
        stream in any::<bool>(),
        jitter in 0.0..1.0_f64,
        // A servo of 8 Hz lags by 2ζ/ω = 32 ms; the A460's peak error is 5 mrad, which is 2 ms of its top speed.
        lag_s in 0.0..0.02_f64,
        noise in 0.0..1e-3_f64,
    ) {
        let mode = if stream { Mode::Stream } else { Mode::Trajectory };
        let settings = GuardSettings::default();
        let mut stage = Stage::new(mode, &settings);
        (stage.jitter, stage.lag_s, stage.noise, stage.lead_s) = (jitter, lag_s, noise, 0.3);
        let mut guarded = Guarded::new(stage, &robot(), &settings, mode);
        let mut sink = Count::default();
        let ending = guarded.perform(&plan(part, rate_hz), &mut sink).unwrap();
        prop_assert!(ending.is_complete(), "{ending:?}");
        prop_assert_eq!(sink.samples, plan(part, rate_hz).layout().unwrap().samples());
        prop_assert!(guarded.arm().deeds.iter().all(|(_, deed)| *deed == Deed::SetPoint));
        prop_assert!(guarded.record().used.values().all(|&used| used < 1.0), "{:?}", guarded.record().used);
    }
}
