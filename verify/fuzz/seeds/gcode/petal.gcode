; A short job: a petal of two arcs, about half a second of motion.
G21 G90 F6000 ; millimetres, 0.1 m/s
G0 X0 Y0
M3
G2 X20 Y0 R14.142
G2 X0 Y0 R14.142
M5
M2
