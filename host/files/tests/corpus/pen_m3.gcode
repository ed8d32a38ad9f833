; a pen on the spindle's output: M3 lowers it, M5 lifts it
G21 G90 G64 P0.05
G61
M5
G4 P0.2
G0 X3 Y4
M03
G4 P0.2
G1 X13 Y4 F2000
G91
G1 X-2 Y6
G90
M05
G0 X0 Y0
M0 (change the paper)
M3 S250
G1 X0 Y8
M5
M30
