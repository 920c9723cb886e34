use armid_cdr::{CdrError, decode, encode};
use proptest::collection::vec;
use proptest::prelude::*;
use ros2_client::Message;
use rustdds::RepresentationIdentifier;
use rustdds::serialization::{deserialize_from_cdr_with_rep_id, to_writer_with_rep_id};

use super::*;

fn numbers() -> impl Strategy<Value = Vec<f64>> {
    vec(any::<f64>().prop_filter("NaN equals nothing", |x| !x.is_nan()), 0..9)
}

fn names() -> impl Strategy<Value = Vec<String>> {
    vec("[a-zäö_0-9]{0,9}", 0..7)
}

fn header() -> impl Strategy<Value = Header> {
    (any::<i32>(), 0..1_000_000_000_u32, "[a-z]{0,5}")
        .prop_map(|(sec, nanosec, frame_id)| Header { stamp: Time { sec, nanosec }, frame_id })
}

prop_compose! {
    fn point()(positions in numbers(), velocities in numbers(), accelerations in numbers(), effort in numbers(),
               time in header()) -> TrajectoryPoint {
        TrajectoryPoint { positions, velocities, accelerations, effort, time_from_start: time.stamp }
    }
}

prop_compose! {
    fn state()(header in header(), name in names(), position in numbers(), velocity in numbers(), effort in numbers())
        -> JointState {
        JointState { header, name, position, velocity, effort }
    }
}

prop_compose! {
    fn goal()(header in header(), joint_names in names(), points in vec(point(), 0..5), component in any::<u16>(),
              x in any::<i16>(), seconds in any::<i32>()) -> FollowGoal {
        let x = f64::from(x);
        let twist = Twist { linear: Vector3 { x, y: 1.0, z: 2.0 }, angular: Vector3::default() };
        let multi = MultiDofPoint { velocities: vec![twist; 2], transforms: vec![Transform::default()], ..Default::default() };
        FollowGoal {
            multi_dof_trajectory: MultiDofTrajectory { points: vec![multi], ..Default::default() },
            path_tolerance: vec![JointTolerance { name: "waist".into(), position: x, ..Default::default() }],
            component_path_tolerance: vec![JointComponentTolerance { component, position: x, ..Default::default() }],
            goal_time_tolerance: Time { sec: seconds, nanosec: 7 },
            trajectory: JointTrajectory { header, joint_names, points },
            ..Default::default()
        }
    }
}

/// Ours and the codec of the DDS library, which is the one on the wire: the same bytes, and each reads the other's.
fn there_and_back<M: Message + PartialEq + std::fmt::Debug>(message: &M) {
    let bytes = encode(message).unwrap();
    assert_eq!(&decode::<M>(&bytes).unwrap(), message);
    let mut wire = Vec::new();
    to_writer_with_rep_id(&mut wire, message, RepresentationIdentifier::CDR_LE).unwrap();
    assert_eq!(bytes[4..], wire);
    let mut big = Vec::new();
    to_writer_with_rep_id(&mut big, message, RepresentationIdentifier::CDR_BE).unwrap();
    assert_eq!(&decode::<M>(&[&[0, 0, 0, 0], big.as_slice()].concat()).unwrap(), message);
    let (read, _) = deserialize_from_cdr_with_rep_id::<M>(&bytes[4..], RepresentationIdentifier::CDR_LE).unwrap();
    assert_eq!(&read, message);
}

proptest! {
    #[test]
    fn identity_decode_undoes_encode(state in state(), goal in goal(), list in numbers(), point in point(), text in ".{0,20}") {
        there_and_back(&state);
        there_and_back(&goal);
        there_and_back(&goal.trajectory);
        there_and_back(&Float64MultiArray::list(list));
        there_and_back(&FollowFeedback { header: state.header.clone(), desired: point, ..Default::default() });
        there_and_back(&FollowResult { error_code: -4, error_string: text.clone() });
        there_and_back(&Text { data: text });
    }

    #[test]
    fn no_bytes_make_a_decoder_panic(mut bytes in vec(any::<u8>(), 0..200), plain in any::<bool>()) {
        if plain && bytes.len() > 1 {
            bytes[0] = 0;
            bytes[1] &= 1;
        }
        let _ = decode::<JointState>(&bytes);
        let _ = decode::<FollowGoal>(&bytes);
        let _ = decode::<FollowFeedback>(&bytes);
        let _ = decode::<FollowResult>(&bytes);
        let _ = decode::<JointTrajectory>(&bytes);
        let _ = decode::<Float64MultiArray>(&bytes);
        let _ = decode::<Text>(&bytes);
    }

    #[test]
    fn no_change_of_a_message_makes_a_decoder_panic(goal in goal(), at in any::<usize>(), to in any::<u8>(), cut in any::<usize>()) {
        let mut bytes = encode(&goal).unwrap();
        let length = bytes.len();
        bytes[at % length] = to;
        let _ = decode::<FollowGoal>(&bytes);
        let _ = decode::<FollowGoal>(&bytes[..cut % length]);
    }
}

/// Written by hand after the rules of CDR: alignment counts from the end of the encapsulation.
#[test]
fn analytic_bytes_of_a_set_point_and_of_a_point() {
    let mut bytes: Vec<u8> = vec![0, 1, 0, 0];
    bytes.extend([0, 0, 0, 0, 0, 0, 0, 0]); // 0: no dimensions, offset 0
    bytes.extend([2, 0, 0, 0, 0, 0, 0, 0]); // 8: two numbers, and 4 bytes up to the next f64
    bytes.extend(0.25_f64.to_le_bytes());
    bytes.extend((-1.0_f64).to_le_bytes());
    assert_eq!(encode(&Float64MultiArray::list(vec![0.25, -1.0])).unwrap(), bytes);

    let point =
        TrajectoryPoint { positions: vec![0.5], time_from_start: Time { sec: 1, nanosec: 2 }, ..Default::default() };
    let mut bytes: Vec<u8> = vec![0, 1, 0, 0];
    bytes.extend([1, 0, 0, 0, 0, 0, 0, 0]); // 0: one position
    bytes.extend(0.5_f64.to_le_bytes()); //     8
    bytes.extend([0; 12]); //                  16: no velocities, accelerations, efforts
    bytes.extend([1, 0, 0, 0, 2, 0, 0, 0]); // 28: time
    assert_eq!(encode(&point).unwrap(), bytes);
}

#[test]
fn analytic_bytes_of_a_joint_state_in_both_orders() {
    let mut big: Vec<u8> = vec![0, 0, 0, 0];
    big.extend([0, 0, 0, 3, 0, 0, 0, 5, 0, 0, 0, 1, 0, 0, 0, 0]); // stamp, "" and 3 bytes up to the next u32
    big.extend([0, 0, 0, 1, 0, 0, 0, 2, b'a', 0, 0, 0]);
    big.extend([0, 0, 0, 1]);
    big.extend(0.25_f64.to_be_bytes());
    big.extend([0, 0, 0, 0, 0, 0, 0, 0]);
    let state = JointState {
        header: Header { stamp: Time { sec: 3, nanosec: 5 }, frame_id: String::new() },
        name: vec!["a".into()],
        position: vec![0.25],
        ..Default::default()
    };
    assert_eq!(decode::<JointState>(&big).unwrap(), state);
    let little = encode(&state).unwrap();
    assert_eq!(little[..12], [0, 1, 0, 0, 3, 0, 0, 0, 5, 0, 0, 0]);
    assert_eq!(little.len(), big.len());
}

#[test]
fn a_list_that_claims_to_be_huge_is_refused() {
    let mut bytes = encode(&Float64MultiArray::list(vec![1.0])).unwrap();
    bytes[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(matches!(decode::<Float64MultiArray>(&bytes), Err(CdrError::Short { .. })));
    assert!(matches!(decode::<Float64MultiArray>(&[0, 3, 0, 0]), Err(CdrError::Encapsulation { .. })));
    assert!(matches!(decode::<Float64MultiArray>(&[]), Err(CdrError::Short { .. })));
}
