; A line in each assembly mode of sim-harness/robots/short_couplers.toml, at --origin 0mm,0mm.
G21 G90
G0 X60 Y125 Z1
G1 Z0 F6000
G1 X60 Y115
G0 Z1
M781 X30 Y12 P0.3
G1 Z0
G1 X33 Y12
G1 X30 Y12
G0 Z1
M781 X60 Y115 P0.3
G1 Z0
G1 X55 Y115
G0 Z1
