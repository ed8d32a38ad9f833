"""Makes tests/data/can_frames.json: frames of both CAN protocols by the encoders of others.

    pip install cantools odrive-can damiao-motor && python3 scripts/can_frames.py > tests/data/can_frames.json

CANSimple: the DBC file of ODrive 0.6.10 in the package `odrive-can`, encoded by `cantools`. MIT-type frames: the package
`damiao-motor`, and the arithmetic of `canmotorlib.py` (mini-cheetah-tmotor-python-can, T-Motor AK drives), which was
written independently: float to integer (x - least) * (2^n - 1) // span. Both must agree, or the script fails.
"""

import json
import random
from pathlib import Path

import cantools
import odrive_can
from damiao_motor.core import motor

DBC = Path(odrive_can.__file__).parent / "dbc/odrive-cansimple-0.6.10.dbc"
NODES = [0, 3, 63]
VALUES = [0.0, 0.125, -0.40625, 2.75, -31.5, 1234.0625]
# Ranges of position [rad], velocity [rad/s] and torque [N·m].
RANGES = {"AK80-9 V2": (12.5, 25.64, 18.0), "AK70-10 V1.1": (12.5, 50.0, 24.0), "DM4310": (12.5, 30.0, 10.0)}
STIFFNESS, DAMPING = 500.0, 5.0


def odrive():
    database = cantools.database.load_file(DBC)
    frames = []

    def add(node, name, **signals):
        message = database.get_message_by_name(f"Axis0_{name}")
        data = message.encode(signals)
        frames.append(
            {"node": node, "name": name, "id": node << 5 | message.frame_id, "data": data.hex(), "signals": signals}
        )

    for node in NODES:
        for value in VALUES:
            add(node, "Set_Input_Pos", Input_Pos=value, Vel_FF=round(-value % 32, 3), Torque_FF=round(value % 16, 3))
            add(node, "Set_Pos_Gain", Pos_Gain=abs(value))
            add(node, "Set_Vel_Gains", Vel_Gain=abs(value), Vel_Integrator_Gain=0.0)
            add(node, "Get_Encoder_Estimates", Pos_Estimate=value, Vel_Estimate=-value)
        for state in [1, 8]:
            add(node, "Set_Axis_State", Axis_Requested_State=state)
            for error in [0, 0x4000000]:
                add(
                    node, "Heartbeat", Axis_Error=error, Axis_State=state, Procedure_Result=0, Trajectory_Done_Flag=0
                )
        add(node, "Set_Controller_Mode", Control_Mode=3, Input_Mode=1)
    return frames


def independent(x, limit, bits, least=None):
    least = -limit if least is None else least
    return int(((x - least) * (2**bits - 1)) / (limit - least))


def mit():
    commands, replies = [], []
    choice = random.Random(1)
    for name, (position, velocity, torque) in RANGES.items():
        drive = motor.DaMiaoMotor.__new__(motor.DaMiaoMotor)
        for key, limit in [("p", position), ("v", velocity), ("t", torque)]:
            setattr(drive, f"_{key}_min", -limit)
            setattr(drive, f"_{key}_max", limit)
        ends = [(-1.0,) * 3 + (0.0,) * 2, (1.0,) * 5, (0.0,) * 5]
        for p, v, t, k, d in ends + [
            tuple(choice.uniform(-1, 1) for _ in range(3)) + (choice.random(), choice.random()) for _ in range(9)
        ]:
            values = [p * position, v * velocity, k * STIFFNESS, d * DAMPING, t * torque]
            data = drive.encode_cmd_msg(*values[:2], values[4], *values[2:4])
            numbers = [
                independent(values[0], position, 16),
                independent(values[1], velocity, 12),
                independent(values[2], STIFFNESS, 12, 0.0),
                independent(values[3], DAMPING, 12, 0.0),
                independent(values[4], torque, 12),
            ]
            packed = 0
            for number, bits in zip(numbers, [16, 12, 12, 12, 12], strict=True):
                packed = packed << bits | number
            if packed.to_bytes(8, "big") != data:
                raise SystemExit(f"the encoders disagree: {name}, {values}")
            commands.append({"ranges": [position, velocity, torque], "values": values, "data": data.hex()})
        for _ in range(8):
            data = bytes([choice.choice([1, 8, 13]) << 4 | 5] + [choice.randrange(256) for _ in range(7)])
            told = drive.decode_sensor_feedback(data)
            replies.append(
                {
                    "ranges": [position, velocity, torque],
                    "data": data.hex(),
                    "id": data[0] & 15,
                    "state": told["status_code"],
                    "values": [told["pos"], told["vel"], told["torq"]],
                }
            )
    return {"commands": commands, "replies": replies}


print(json.dumps({"odrive": odrive(), "mit": mit()}, indent=1))
