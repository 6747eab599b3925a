"""Flights per core-second of JSBSim and RocketPy, each as its users run it.

In: nothing. Out: a line each on the terminal. By hand: `pip install jsbsim rocketpy`, then `python other_programs.py`.
Neither knows a tether or a tunnel, so the lander falls through still air for 30 s, which is the same flow without the wandering of
V_W. JSBSim gets its mass, inertia and aerodynamic terms; RocketPy a rocket of that mass and drag with a nose and fins. Best
processor time of several, after one flight to warm up.
"""

import math
import sys
import tempfile
import time
from importlib.metadata import version
from pathlib import Path

import jsbsim
from rocketpy import Environment, Flight, Rocket

MASS, IXX, IYY, IZZ, D = 0.7873, 0.02113, 0.0138, 0.01379, 0.2125
CA, CN, CN3, CL_P, CM, CM3, CMQ, CMQ2 = 6.6620, 3.5129, -2.0035, -5.6816, -2.0655, 2.5278, -3.3025, -205.4289
AREA = math.pi * D * D / 4
DURATION, DT, SPEED, FT = 30.0, 0.01, 7.43, 0.3048


def product(*terms: object) -> str:
    return "<product>" + "".join(f"<value>{t}</value>" if isinstance(t, float) else str(t) for t in terms) + "</product>"


def prop(name: str) -> str:
    return f"<property>{name}</property>"


def aircraft() -> str:
    """The lander in JSBSim's language. Sines are velocity components over airspeed; moments in lbf ft."""
    qs = prop("aero/qbar-psf") + prop("metrics/Sw-sqft")
    d = prop("metrics/bw-ft")
    u, v, w = (prop(f"velocities/{c}-aero-fps") for c in "uvw")
    speed = prop("velocities/vt-fps")
    lateral = f"<quotient><sum>{product(v, v)}{product(w, w)}</sum>{product(speed, speed)}</quotient>"

    def sine(component: str) -> str:
        return f"<quotient>{component}{speed}</quotient>"

    def cubic(a: float, b: float) -> str:
        return f"<sum><value>{a}</value>{product(b, lateral)}</sum>"

    def damping(angle: str, rate: str, dot: str, sign: float) -> str:
        slope = f"<sum><value>{CMQ}</value>{product(CMQ2, angle, angle)}</sum>"
        rates = f"<sum>{prop(rate)}{product(sign, prop(dot))}</sum>"
        return f"<quotient>{product(qs, d, d, 0.25, slope, rates)}{speed}</quotient>"

    alpha = damping(prop("aero/alpha-rad"), "velocities/q-aero-rad_sec", "aero/alphadot-rad_sec", 1.0)
    beta = damping(prop("aero/beta-rad"), "velocities/r-aero-rad_sec", "aero/betadot-rad_sec", -1.0)
    roll = f"<quotient>{product(qs, d, d, 0.5 * CL_P, prop('velocities/p-aero-rad_sec'))}{speed}</quotient>"
    axes = {
        "X": [product(qs, -CA, sine(u))],
        "Y": [product(qs, -1.0, cubic(CN, CN3), sine(v))],
        "Z": [product(qs, -1.0, cubic(CN, CN3), sine(w))],
        "ROLL": [roll],
        "PITCH": [product(qs, d, cubic(CM, CM3), sine(w)), alpha],
        "YAW": [product(qs, d, -1.0, cubic(CM, CM3), sine(v)), beta],
    }
    functions = "".join(
        f'<axis name="{axis}">' + "".join(f'<function name="aero/{axis}{i}">{f}</function>' for i, f in enumerate(all_)) + "</axis>"
        for axis, all_ in axes.items()
    )
    point = '<location name="{0}" unit="M"><x>0</x><y>0</y><z>0</z></location>'
    return f"""<?xml version="1.0"?>
<fdm_config name="lander" version="2.0" release="BETA">
<fileheader/>
<metrics><wingarea unit="M2">{AREA}</wingarea><wingspan unit="M">{D}</wingspan><chord unit="M">{D}</chord>
{point.format("AERORP")}{point.format("EYEPOINT")}{point.format("VRP")}</metrics>
<mass_balance><ixx unit="KG*M2">{IXX}</ixx><iyy unit="KG*M2">{IYY}</iyy><izz unit="KG*M2">{IZZ}</izz>
<ixy unit="KG*M2">0</ixy><ixz unit="KG*M2">0</ixz><iyz unit="KG*M2">0</iyz>
<emptywt unit="KG">{MASS}</emptywt>{point.format("CG")}</mass_balance>
<ground_reactions/><propulsion/><flight_control name="none"/>
<aerodynamics>{functions}</aerodynamics>
</fdm_config>"""


def fly_jsbsim(fdm: jsbsim.FGFDMExec) -> float:
    """Nose down, 18° off the vertical; the fall speed after 30 s, m/s."""
    for name, value in {"h-sl-ft": 3000, "theta-deg": -72, "u-fps": SPEED / FT, "q-rad_sec": 0.4, "p-rad_sec": 0.2}.items():
        fdm[f"ic/{name}"] = value
    fdm.run_ic()
    for _ in range(round(DURATION / DT)):
        fdm.run()
    return float(fdm["velocities/v-down-fps"]) * FT


def jsbsim_ready(folder: Path) -> jsbsim.FGFDMExec:
    (folder / "aircraft/lander").mkdir(parents=True)
    (folder / "aircraft/lander/lander.xml").write_text(aircraft())
    fdm = jsbsim.FGFDMExec(str(folder), None)
    fdm.set_debug_level(0)
    assert fdm.load_model("lander")
    fdm.set_dt(DT)
    return fdm


def rocketpy_ready() -> tuple[Rocket, Environment]:
    env = Environment()
    env.set_atmospheric_model(type="standard_atmosphere")
    rocket = Rocket(
        radius=D / 2,
        mass=MASS,
        inertia=(IYY, IZZ, IXX),
        power_off_drag=CA,
        power_on_drag=CA,
        center_of_mass_without_motor=0,
        coordinate_system_orientation="tail_to_nose",
    )
    rocket.add_nose(length=D, kind="conical", position=D)
    rocket.add_trapezoidal_fins(4, root_chord=D / 2, tip_chord=D / 4, span=D, position=-D)
    return rocket, env


def fly_rocketpy(rocket: Rocket, env: Environment) -> float:
    """Nose down, 18° off the vertical, default settings; the fall speed after 30 s, m/s."""
    half = math.radians(180 - 18) / 2
    start = [0, 0, 0, 900, 0, 0, -SPEED, math.cos(half), math.sin(half), 0, 0, 0.4, 0, 0.2]
    flight = Flight(rocket, env, rail_length=1, initial_solution=start, max_time=DURATION)
    return float(-flight.solution[-1][6])


def best(work, repetitions: int) -> float:
    times = []
    for _ in range(repetitions):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return min(times)


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        fdm = jsbsim_ready(Path(folder))
        rocket, env = rocketpy_ready()
        print(f"Python {sys.version.split()[0]}")
        for name, work, repetitions in [
            (f"JSBSim {version('jsbsim')}", lambda: fly_jsbsim(fdm), 20),
            (f"RocketPy {version('rocketpy')}", lambda: fly_rocketpy(rocket, env), 5),
        ]:
            speed = work()
            print(f"{name:20s} {1 / best(work, repetitions):9.2f} flights/s a core; falls at {speed:.2f} m/s after {DURATION:g} s")


if __name__ == "__main__":
    main()
