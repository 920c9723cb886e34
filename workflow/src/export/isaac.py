
def actuators(stiffness, damping):
    """Settings of each joint's actuator, {joint: {...}}, for Isaac Lab 2.3 or later (Isaac Sim 5), in N·m, rad, s (N, m, s).

    `stiffness` and `damping` are gains of the position controller: a number, or one for each joint. Links are those of the
    MJCF of the same estimate. Isaac Lab has no load friction, no soft onset and no torque offset.
    """
    gain = lambda value, i: float(value[i]) if hasattr(value, "__len__") else float(value)  # noqa: E731
    found = {}
    for i, joint in enumerate(JOINTS):
        value = lambda symbol: PARAMETERS.get(f"{symbol}{i + 1}", 0.0)  # noqa: B023, E731
        found[joint] = {
            "stiffness": gain(stiffness, i),
            "damping": gain(damping, i),
            "armature": value("Ia"),
            "friction": value("Fc"),
            "dynamic_friction": value("Fc"),
            "viscous_friction": value("Fv"),
            "effort_limit_sim": EFFORT[i],
            "velocity_limit_sim": VELOCITY[i],
        }
    return found


def isaac_lab(stiffness, damping, delay_steps=0):
    """The same as configurations of Isaac Lab, for `ArticulationCfg(actuators=...)`; a delay is in steps of the physics."""
    from isaaclab.actuators import DelayedPDActuatorCfg, ImplicitActuatorCfg

    made = {}
    for joint, settings in actuators(stiffness, damping).items():
        if delay_steps:
            # An explicit controller clips torque itself.
            limits = {"effort_limit": settings["effort_limit_sim"], "min_delay": delay_steps, "max_delay": delay_steps}
            made[joint] = DelayedPDActuatorCfg(joint_names_expr=[joint], **settings, **limits)
        else:
            made[joint] = ImplicitActuatorCfg(joint_names_expr=[joint], **settings)
    return made
