import math


class Friction:
    """Friction and offset of the joints by every identified law. MuJoCo has only viscous and dry friction.

    ```python
    model, friction = mujoco.MjModel.from_xml_string(MJCF), Friction()
    data = mujoco.MjData(model)
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
