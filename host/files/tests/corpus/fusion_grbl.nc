%
(1001)
(T1  D=3.175 CR=0 - ZMIN=-1 - FLAT END MILL)
G90 G94
G17
G21
(When using Fusion for Personal Use, the feedrate of rapid)
(moves is reduced to match the feedrate of cutting moves)
G28 G91 Z0
G90
(2D Contour1)
T1
S5000 M3
G17 G90 G94
G54
M8
G0 X-1.587 Y5
G0 Z15
Z5
G1 Z1 F1000
Z-1 F333.3
Y20 F800
G2 X0 Y21.587 I1.587 J0
G1 X30
G2 X31.587 Y20 I0 J-1.587
G1 Y0
X10 Y0
G1 X8 Y0 Z1 F1000
G0 Z15
M9
M5
G28 G91 Z0
G90
G28 G91 X0 Y0
G90
M30
%
