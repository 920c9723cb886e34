//! Joint states over time.

/// Positions, velocities and accelerations of `n` joints at `N` samples, each row-major `N × n`.
///
/// Units rad, rad/s, rad/s² (m for a prismatic joint); joint angles count from the robot's own zero.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::trajectory::States;
/// let mut states = States::new(2);
/// states.push(&[0.1, 0.2], &[0.0, 0.0], &[1.0, -1.0]);
/// assert_eq!(states.len(), 1);
/// assert_eq!(states.q(0), &[0.1, 0.2]);
/// assert_eq!(states.qdd(0), &[1.0, -1.0]);
/// ```
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct States {
    /// Number of joints n.
    pub dof: usize,
    /// Positions, `N × n` row-major, rad.
    pub q: Vec<f64>,
    /// Velocities, `N × n` row-major, rad/s.
    pub qd: Vec<f64>,
    /// Accelerations, `N × n` row-major, rad/s².
    pub qdd: Vec<f64>,
}

impl States {
    /// No samples of `dof` joints.
    pub const fn new(dof: usize) -> Self {
        Self { dof, q: Vec::new(), qd: Vec::new(), qdd: Vec::new() }
    }

    /// `len` samples of `dof` joints, all zero.
    pub fn with_len(dof: usize, len: usize) -> Self {
        let zeros = vec![0.0; dof * len];
        Self { dof, q: zeros.clone(), qd: zeros.clone(), qdd: zeros }
    }

    /// Number of samples N.
    pub fn len(&self) -> usize {
        self.q.len().checked_div(self.dof).unwrap_or(0)
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.q.is_empty()
    }

    /// Positions, velocities and accelerations of all samples, `N × n` row-major each.
    pub fn arrays(&self) -> [&[f64]; 3] {
        [&self.q, &self.qd, &self.qdd]
    }

    /// Adds one sample.
    ///
    /// # Panics
    /// If a slice does not hold one value per joint.
    pub fn push(&mut self, q: &[f64], qd: &[f64], qdd: &[f64]) {
        assert!(
            q.len() == self.dof && qd.len() == self.dof && qdd.len() == self.dof,
            "one value per joint: found {}, {} and {}, expected {}",
            q.len(),
            qd.len(),
            qdd.len(),
            self.dof
        );
        self.q.extend_from_slice(q);
        self.qd.extend_from_slice(qd);
        self.qdd.extend_from_slice(qdd);
    }

    /// Positions, velocities and accelerations of sample `k`, n each.
    pub fn sample(&self, k: usize) -> [&[f64]; 3] {
        [self.q(k), self.qd(k), self.qdd(k)]
    }

    /// What [`arrays`](Self::arrays) returns, to write.
    pub fn arrays_mut(&mut self) -> [&mut [f64]; 3] {
        [&mut self.q, &mut self.qd, &mut self.qdd]
    }

    /// What [`sample`](Self::sample) returns, to write.
    pub fn sample_mut(&mut self, k: usize) -> [&mut [f64]; 3] {
        let n = self.dof;
        [&mut self.q, &mut self.qd, &mut self.qdd].map(|x| &mut x[k * n..(k + 1) * n])
    }

    /// Positions of sample `k`, n.
    #[inline]
    pub fn q(&self, k: usize) -> &[f64] {
        &self.q[k * self.dof..(k + 1) * self.dof]
    }

    /// Velocities of sample `k`, n.
    #[inline]
    pub fn qd(&self, k: usize) -> &[f64] {
        &self.qd[k * self.dof..(k + 1) * self.dof]
    }

    /// Accelerations of sample `k`, n.
    #[inline]
    pub fn qdd(&self, k: usize) -> &[f64] {
        &self.qdd[k * self.dof..(k + 1) * self.dof]
    }
}
