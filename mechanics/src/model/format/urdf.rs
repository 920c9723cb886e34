//! URDF: the serial chain of a ROS robot description.
//!
//! The frame of a link is that of the joint that moves it, as the file states it (not turned onto the axis), so that
//! the parameters are those of other tools which read the same file:
//!
//! ```text
//! T(q) = origin · Rot(axis, q) = (origin · R) · Rz(q) · Rᵀ        R z = axis
//! ```
//! Collision shapes are read, but not the files of meshes. Not read: transmissions, sensors, simulator extensions.
//! Reference: the URDF/XML specification of the Robot Operating System.

use crate::input::size::LINKS;
use crate::model::term::{COULOMB, VISCOUS};

use nalgebra::{Matrix3, Vector3};

use super::collision::{Geometry, read_geometry};
use super::element::{Element, NearlyRight, parse_xml, snapped_direction, snapped_sincos, turn_z_to};
use super::error::FormatError;
use super::reading::STANDARD_GRAVITY;
use super::tree::{Body, ChainEnds, Connection, ImportedModel, MovingJoint, SnappedJoint, Tree, moved};
use crate::model::joint::{JointKind, Limits};
use crate::model::parameters::DriveParameters;
use crate::spatial::{Inertia, Placement};

/// Reads the serial chain of a URDF.
///
/// Links that fixed joints connect become one. Where no tip is given and every moving joint lies on one chain, that
/// chain is taken. Effort limits, `damping` and `friction` become torque limit, viscous and Coulomb friction; the
/// effort interface is a torque, gravity 9.81 m/s² along −z of the root. Joints off the chain are held at zero and
/// listed. A limit of zero is what exporters write for none, and is read so, with a remark. Angles and axes of the
/// chain within 5e-5 rad of a right angle are right, with a remark that names the joints: `1.5708` means π/2.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::format::{ChainEnds, parse_urdf};
/// let text = r#"<robot name="pendulum"><link name="world"/>
///   <link name="rod"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
///     <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.01"/></inertial></link>
///   <joint name="swing" type="continuous"><parent link="world"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>"#;
/// let model = parse_urdf(text, &ChainEnds::default()).unwrap();
/// assert_eq!(model.robot.joints()[0].name, "swing");
/// assert_eq!(model.parameters.links[0].to_array(), [2.0, 0.0, 0.0, -1.0, 0.6, 0.0, 0.0, 0.6, 0.0, 0.01]);
/// ```
///
/// # Errors
/// [`FormatError`] with line and column: malformed XML, a missing or malformed attribute, a link that does not exist or
/// has two parents, a tree without a tip (the leaves are listed), a planar, floating or mimic joint on the chain.
pub fn parse_urdf(text: &str, ends: &ChainEnds) -> Result<ImportedModel, FormatError> {
    let document = parse_xml(text)?;
    let tree = read_tree(Element::root(&document), text, NearlyRight::Snapped)?;
    tree.chain(ends).map(|model| ImportedModel { robot: model.robot.with_source(text), ..model })
}

/// Reads a URDF and keeps every angle as it is written, rounded right angles too, as readers do that do not mend them.
///
/// # Errors
/// As [`parse_urdf`].
pub fn parse_urdf_as_written(text: &str, ends: &ChainEnds) -> Result<ImportedModel, FormatError> {
    let document = parse_xml(text)?;
    read_tree(Element::root(&document), text, NearlyRight::AsWritten)?.chain(ends)
}

/// The tree of a whole file.
pub(super) fn read_tree<'a>(root: Element<'a>, text: &str, nearly: NearlyRight) -> Result<Tree<'a>, FormatError> {
    if root.tag() != "robot" {
        return root.fault(format!("the root element is <{}>, expected <robot>", root.tag()));
    }
    if text.contains("xmlns:xacro") && root.elements().any(|element| element.is_of("xacro")) {
        return root.fault("the file is a xacro template, expected a URDF; `xacro FILE > arm.urdf` makes one");
    }
    let links: Vec<Element<'_>> = root.all("link").collect();
    LINKS.check_count("number of links", links.len()).or_else(|fault| root.fault(fault.to_string()))?;
    let mut names: Vec<&str> = Vec::with_capacity(links.len());
    for link in &links {
        let name = link.required("name")?;
        if names.contains(&name.value()) {
            let message = format!("link \"{}\" is there twice, expected it once", name.value());
            return root.check.fault(name.range_value(), message);
        }
        names.push(name.value());
    }
    if links.is_empty() {
        return root.fault("the robot has no links, expected at least two");
    }
    let mut remarks = Vec::new();
    // The joint that carries each link.
    let mut carrier: Vec<Option<UrdfJoint<'_>>> = links.iter().map(|_| None).collect();
    for element in root.all("joint") {
        let joint = UrdfJoint::read(element, &names, nearly)?;
        let child = joint.child;
        if let Some(other) = carrier[child].replace(joint) {
            let message = format!("link \"{}\" already hangs on joint \"{}\"", names[child], other.name);
            return element.fault(format!("{message}, expected a tree"));
        }
    }
    Ok(Tree {
        check: root.check,
        at: root.span(),
        name: root.attribute("name").map_or("unnamed", |name| name.value()).to_owned(),
        gravity: Vector3::from(STANDARD_GRAVITY),
        bodies: bodies(root, &links, &names, &carrier, &mut remarks)?,
        rotors: Vec::new(),
        snapped: Vec::new(),
        remarks,
    })
}

/// The collision shapes of a link; one that cannot be read is there with its fault.
fn collision_shapes(link: Element<'_>) -> Vec<(Placement, Result<Geometry, FormatError>)> {
    let of = |collision: Element<'_>| match read_origin(collision) {
        Ok(placement) if placement.is_rigid() => (placement, read_geometry(collision)),
        Ok(_) => (Placement::identity(), collision.fault("<origin> of <collision> is beyond all numbers")),
        Err(fault) => (Placement::identity(), Err(fault)),
    };
    link.all("collision").map(of).collect()
}

/// The bodies from the root outwards.
fn bodies(
    root: Element<'_>,
    links: &[Element<'_>],
    names: &[&str],
    carrier: &[Option<UrdfJoint<'_>>],
    remarks: &mut Vec<String>,
) -> Result<Vec<Body>, FormatError> {
    let mut order: Vec<usize> = (0..links.len()).filter(|&link| carrier[link].is_none()).collect();
    if order.len() != 1 {
        let roots: Vec<&str> = order.iter().map(|&link| names[link]).collect();
        let found = if roots.is_empty() { "a loop".to_owned() } else { super::reading::quoted(&roots) };
        return root.fault(format!("the links without a parent are {found}, expected exactly one"));
    }
    let mut next = 0;
    let mut bodies = Vec::with_capacity(links.len());
    while next < order.len() {
        let link = order[next];
        let inertia = Ok(read_inertial(links[link])?);
        let shapes = collision_shapes(links[link]);
        bodies.push(match &carrier[link] {
            None => Body { inertia, shapes, ..Body::root(names[link], links[link].span()) },
            Some(joint) => Body {
                parent: order.iter().position(|&parent| parent == joint.parent),
                placement: joint.origin,
                snapped: joint.snapped()?,
                connection: joint.connection(remarks)?,
                inertia,
                shapes,
                ..Body::root(names[link], joint.element.span())
            },
        });
        order.extend((0..links.len()).filter(|&child| carrier[child].as_ref().is_some_and(|j| j.parent == link)));
        next += 1;
    }
    if let Some(lost) = (0..links.len()).find(|link| !order.contains(link)) {
        return links[lost].fault(format!("link \"{}\" hangs in a loop, expected a tree", names[lost]));
    }
    Ok(bodies)
}

/// One `<joint>`.
struct UrdfJoint<'a> {
    element: Element<'a>,
    name: String,
    parent: usize,
    child: usize,
    origin: Placement,
    /// By how much its angles were off the right angles that they are read as, rad.
    off: f64,
    nearly: NearlyRight,
}

impl<'a> UrdfJoint<'a> {
    fn read(element: Element<'a>, links: &[&str], nearly: NearlyRight) -> Result<Self, FormatError> {
        let end = |tag: &'static str| {
            let Some(end) = element.only(tag)? else {
                return element.fault(format!("<joint> has no <{tag}>, expected one"));
            };
            let link = end.required("link")?;
            links.iter().position(|name| *name == link.value()).map_or_else(
                || {
                    let message = format!("{tag} link \"{}\" is not there, expected one of the links", link.value());
                    element.check.fault(link.range_value(), message)
                },
                Ok,
            )
        };
        let (origin, off) = read_snapped_origin(element, nearly)?;
        Ok(Self {
            name: element.required("name")?.value().to_owned(),
            parent: end("parent")?,
            child: end("child")?,
            origin,
            off,
            nearly,
            element,
        })
    }

    /// The joint's axis, along a coordinate axis where it nearly is, and by how much it was off, rad.
    fn axis(&self) -> Result<(Vector3<f64>, f64), FormatError> {
        match self.element.only("axis")? {
            Some(axis) => Ok(snapped_direction(&axis.direction_of(&axis.required("xyz")?)?, self.nearly)),
            None => Ok((Vector3::x(), 0.0)),
        }
    }

    /// Its name and the largest angle by which it was off what it is read as, rad.
    fn snapped(&self) -> Result<Option<SnappedJoint>, FormatError> {
        let moves = self.element.required("type")?.value() != "fixed";
        let off = if moves { self.off.max(self.axis()?.1) } else { self.off };
        Ok((off > 0.0).then(|| SnappedJoint { name: self.name.clone(), angle_rad: off }))
    }

    fn connection(&self, remarks: &mut Vec<String>) -> Result<Connection, FormatError> {
        let kind = self.element.required("type")?;
        let unsupported = |what: &str| Ok(Connection::Unsupported(self.name.clone(), what.to_owned()));
        let mimic = self.element.only("mimic")?;
        if kind.value() == "fixed" {
            if mimic.is_some() {
                remarks.push(format!("joint \"{}\": the mimic of a fixed joint is passed over", self.name));
            }
            return Ok(Connection::Fixed);
        }
        if let Some(mimic) = mimic {
            let leader = mimic.required("joint")?.value().to_owned();
            return Ok(Connection::Follows { joint: self.name.clone(), leader });
        }
        let (kind, limited) = match kind.value() {
            "revolute" => (JointKind::Revolute, true),
            "continuous" => (JointKind::Revolute, false),
            "prismatic" => (JointKind::Prismatic, true),
            many @ ("floating" | "planar") => return unsupported(many),
            other => {
                let message = format!(
                    "joint type is \"{other}\", expected revolute, continuous, prismatic, fixed, floating or planar"
                );
                return self.element.check.fault(kind.range_value(), message);
            }
        };
        let (axis, _) = self.axis()?;
        Ok(Connection::Moving(MovingJoint {
            name: self.name.clone(),
            kind,
            axis: Placement::new(turn_z_to(&axis), Vector3::zeros()),
            limits: self.limits(limited, remarks)?,
            drive: self.friction()?,
        }))
    }

    fn limits(&self, limited: bool, remarks: &mut Vec<String>) -> Result<Limits, FormatError> {
        let mut limits = Limits::NONE;
        let Some(limit) = self.element.only("limit")? else {
            if limited {
                return self.element.fault(format!("joint \"{}\" has no <limit>, expected one", self.name));
            }
            return Ok(limits);
        };
        for (key, slot) in [("velocity", &mut limits.velocity), ("effort", &mut limits.torque)] {
            let Some(attribute) = limit.attribute(key) else { continue };
            let [value] = limit.numbers_of::<1>(&attribute)?;
            if value < 0.0 {
                let message = format!("{key} is {value}, expected a number not below zero");
                return self.element.check.fault(attribute.range_value(), message);
            }
            if value > 0.0 {
                *slot = value;
            } else {
                remarks.push(format!("joint \"{}\": the {key} limit 0 is read as no limit", self.name));
            }
        }
        if limited {
            let (low, high) = (limit.number("lower")?.unwrap_or(0.0), limit.number("upper")?.unwrap_or(0.0));
            if low < high {
                limits.position = (low, high);
            } else if low == 0.0 && high == 0.0 {
                remarks.push(format!("joint \"{}\": the position limits 0 and 0 are read as no limit", self.name));
            } else {
                let message = format!("limits are {low} to {high}, expected the lower below the upper");
                return limit.fault(message);
            }
        }
        Ok(limits)
    }

    fn friction(&self) -> Result<DriveParameters, FormatError> {
        let mut drive = DriveParameters::default();
        if let Some(dynamics) = self.element.only("dynamics")? {
            drive[VISCOUS] = dynamics.number("damping")?.unwrap_or(0.0);
            drive[COULOMB] = dynamics.number("friction")?.unwrap_or(0.0);
        }
        Ok(drive)
    }
}

/// The `<origin>` of an inertial, the identity where there is none.
pub(super) fn read_origin(element: Element<'_>) -> Result<Placement, FormatError> {
    Ok(read_snapped_origin(element, NearlyRight::AsWritten)?.0)
}

/// The `<origin>` of a joint with right angles where it nearly has them, and by how much one was off at most, rad.
fn read_snapped_origin(element: Element<'_>, nearly: NearlyRight) -> Result<(Placement, f64), FormatError> {
    let Some(origin) = element.only("origin")? else { return Ok((Placement::identity(), 0.0)) };
    let [x, y, z] = origin.numbers("xyz")?.unwrap_or_default();
    let angles = origin.numbers::<3>("rpy")?.unwrap_or_default().map(|angle| snapped_sincos(angle, nearly));
    let [(roll, _), (pitch, _), (yaw, _)] = angles;
    // Tr(xyz) Rz(yaw) Ry(pitch) Rx(roll)
    let placed = Placement::translation(x, y, z)
        .compose(&Placement::rotation_z(yaw.0, yaw.1))
        .compose(&Placement::rotation_y(pitch.0, pitch.1))
        .compose(&Placement::rotation_x(roll.0, roll.1));
    Ok((placed, angles.iter().fold(0.0, |most: f64, (_, off)| most.max(*off))))
}

/// The inertia of a link in its own frame; zero where the file gives none.
pub(super) fn read_inertial(link: Element<'_>) -> Result<Inertia, FormatError> {
    let Some(inertial) = link.only("inertial")? else { return Ok(Inertia::zero()) };
    let missing = |tag: &str| inertial.fault(format!("<inertial> has no <{tag}>, expected one"));
    let required = |tag: &'static str| inertial.only(tag)?.map_or_else(|| missing(tag), Ok);
    let mass = required("mass")?.number_not_below_zero("value")?;
    let inertia = required("inertia")?;
    let i = |key: &str| inertia.required_number(key);
    let [xx, xy, xz, yy, yz, zz] = [i("ixx")?, i("ixy")?, i("ixz")?, i("iyy")?, i("iyz")?, i("izz")?];
    let about_com =
        Inertia { mass, first_moment: Vector3::zeros(), rotational: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) };
    Ok(moved(&about_com, &read_origin(inertial)?))
}
