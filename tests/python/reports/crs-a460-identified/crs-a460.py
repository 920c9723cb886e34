"""crs-a460 identified from /tmp/tmpekwag4v4/log.csv by armid 0.1.0.
this file predicts this log with 1.19 % (estimate: 1.19 %).
The guess of the bodies weighs 0.01."""

# Joints, in the order of every list; a parameter's number counts from 1.
JOINTS = ["waist", "shoulder", "elbow", "wrist_roll", "wrist_pitch", "tool_roll"]
# Largest torque, N·m (N), and speed, rad/s (m/s); None where the robot file states none.
EFFORT = [39.5, 66.08, 39.5, 6.89, 6.82, 2.5]
VELOCITY = [3.141592653589793, 3.141592653589793, 3.141592653589793, 2.9845130209103035, 3.01941960595019, 2.9845130209103035]
# SI units; inertias about the origin of each link's frame.
PARAMETERS = {
  "Fc1": 6.044001421625786,
  "Fc2": 7.868782895233457,
  "Fc3": 4.970885232035923,
  "Fc4": 2.0426059087202924,
  "Fc5": 1.5095481584219719,
  "Fc6": 1.0059385158722105,
  "Fl1": 0.04830567528985568,
  "Fl2": 0.08008266848485515,
  "Fl3": 0.06223199498904887,
  "Fl4": 0.09823956054626097,
  "Fl5": 0.07894479207672303,
  "Fl6": 0.09662706036335293,
  "Fo1": 0.0,
  "Fo2": 0.0,
  "Fo3": 0.0,
  "Fo4": 0.0,
  "Fo5": 0.0,
  "Fo6": 0.0,
  "Fv1": 7.954085444485019,
  "Fv2": 9.108899237444767,
  "Fv3": 6.978107309988548,
  "Fv4": 1.9763230747924598,
  "Fv5": 1.9918179774129774,
  "Fv6": 0.9980895408589149,
  "Ia1": 0.0,
  "Ia2": 0.0,
  "Ia3": 0.0,
  "Ia4": 0.0,
  "Ia5": 0.0,
  "Ia6": 0.0,
  "Ixx1": 0.8897313704815589,
  "Ixx2": 0.11995516611350504,
  "Ixx3": 0.056231296039943014,
  "Ixx4": 0.6157585755733768,
  "Ixx5": 0.36117193912301937,
  "Ixx6": 0.10181217390982762,
  "Ixy1": 0.0,
  "Ixy2": -0.08036253969840937,
  "Ixy3": 0.013892288623303176,
  "Ixy4": 0.01881636097746843,
  "Ixy5": 0.019139465476539202,
  "Ixy6": 0.008697656917649238,
  "Ixz1": 0.0,
  "Ixz2": 0.014621771553842684,
  "Ixz3": 0.01583764129613759,
  "Ixz4": -0.010652677960612908,
  "Ixz5": 0.008197863593674167,
  "Ixz6": -0.012594657118177546,
  "Iyy1": 0.866277740963115,
  "Iyy2": 0.6782581216198464,
  "Iyy3": 0.22913675833688424,
  "Iyy4": 0.5951755816188378,
  "Iyy5": 0.5528280029012709,
  "Iyy6": 0.2058995003057316,
  "Iyz1": 0.0,
  "Iyz2": 0.03738346628602888,
  "Iyz3": -0.019319323369612985,
  "Iyz4": 0.03890821315680549,
  "Iyz5": -0.025214045100829648,
  "Iyz6": 0.013167400102432105,
  "Izz1": 0.8897313704815564,
  "Izz2": 0.7254964651282547,
  "Izz3": 0.19850088558290416,
  "Izz4": 0.41507893946115104,
  "Izz5": 0.1999690752634573,
  "Izz6": 0.3012996933048414,
  "coulomb_velocity_rad_s1": 0.09856522708767836,
  "coulomb_velocity_rad_s2": 0.0805034233311011,
  "coulomb_velocity_rad_s3": 0.1183133542770603,
  "coulomb_velocity_rad_s4": 0.15434334773612615,
  "coulomb_velocity_rad_s5": 0.10305088995939776,
  "coulomb_velocity_rad_s6": 0.2019190501101015,
  "m1": 7.699999999999999,
  "m2": 5.67840390465053,
  "m3": 7.791733494322614,
  "m4": 2.450686074403423,
  "m5": 2.949814130237044,
  "m6": 6.582159624857381,
  "mcx1": 0.0,
  "mcx2": -1.541867339748832,
  "mcx3": 0.09546575054923137,
  "mcx4": 0.10857014892723833,
  "mcx5": 0.09936717504979302,
  "mcx6": 0.10036890931824205,
  "mcy1": -1.5785,
  "mcy2": -0.20149367182480515,
  "mcy3": -0.23251364795794785,
  "mcy4": -0.09667475765414113,
  "mcy5": -0.03639521173780591,
  "mcy6": -0.19959515551859947,
  "mcz1": 0.0,
  "mcz2": 0.1225138657281609,
  "mcz3": -0.4668245941078305,
  "mcz4": 0.46437712135922926,
  "mcz5": -0.3802113285457569,
  "mcz6": -0.017899002994939524
}

import math


class Friction:
    """Friction and offset of the joints by every identified law. MuJoCo has only viscous and dry friction.

    ```python
    friction = Friction()
    friction.take_over(model)                       # damping and frictionloss of these joints become zero
    while True:
        data.ctrl[:] = ...
        mujoco.mj_step1(model, data)
        friction.apply(model, data)
        mujoco.mj_step2(model, data)
    ```
    """

    def torque(self, position, velocity, load):
        """Torque that friction takes of each joint, N·m (N); `load` is the torque that the links take, without friction."""
        return [self._of(i, *state)[0] for i, state in enumerate(zip(position, velocity, load))]

    def _of(self, i, q, v, load):
        """Torque of joint i, and its slope by velocity."""
        value = lambda symbol: PARAMETERS.get(f"{symbol}{i + 1}", 0.0)  # noqa: E731
        onset = value("coulomb_velocity_rad_s")
        sign = math.tanh(v / onset) if onset else float((v > 0) - (v < 0))
        slope = (1 - sign**2) / onset if onset else 0.0
        dry = value("Fc") + value("Fl") * abs(load)
        if value("Fs"):
            dry += value("Fs") * math.exp(-((v / value("stribeck_velocity_rad_s")) ** 2))
        if value("Fpc") or value("Fps"):
            angle = q / value("friction_wave_rad")
            dry += value("Fpc") * math.cos(angle) + value("Fps") * math.sin(angle)
        torque = value("Fv") * v + value("Fq") * v * abs(v) + dry * sign + value("Fd") * sign**2 + value("Fo")
        return torque, max(value("Fv") + 2 * value("Fq") * abs(v) + dry * slope, 0.0)

    def take_over(self, model):
        """Takes damping and dry friction of these joints out of a model of MuJoCo, and gives it the rotor inertias."""
        for i, joint in enumerate(JOINTS):
            dof = model.joint(joint).dofadr[0]
            model.dof_damping[dof] = model.dof_frictionloss[dof] = 0.0
            model.dof_armature[dof] = PARAMETERS.get(f"Ia{i + 1}", 0.0)

    def apply(self, model, data):
        """Sets the friction of this step in MuJoCo's `qfrc_applied`, between `mj_step1` and `mj_step2`.

        The onset of friction is steep, so the step is linearly implicit: τ / (1 + h τ' / M), M the joint's own inertia. The load
        is that of the step before.
        """
        import mujoco
        import numpy as np

        inertia, taken, unit = np.zeros(model.nv), np.zeros(model.nv), np.zeros(model.nv)
        mujoco.mj_mulM(model, data, taken, np.array(data.qacc))
        for i, joint in enumerate(JOINTS):
            place, dof = model.joint(joint).qposadr[0], model.joint(joint).dofadr[0]
            unit[:] = 0.0
            unit[dof] = 1.0
            mujoco.mj_mulM(model, data, inertia, unit)
            load = data.qfrc_bias[dof] + taken[dof] - model.dof_armature[dof] * data.qacc[dof]
            torque, slope = self._of(i, data.qpos[place], data.qvel[dof], load)
            data.qfrc_applied[dof] = -torque / (1 + model.opt.timestep * slope / inertia[dof])
