(Exported by FreeCAD)
(Post Processor: grbl_post)
(Output Time:2025-02-11 09:12:44.113022)
(Begin preamble)
G17 G90
G21
(Begin operation: Fixture)
(Path: Fixture)
G54
(Finish operation: Fixture)
(Begin operation: TC: 3mm Endmill)
(Begin toolchange)
( M6 T1 )
M3 S18000
(Finish operation: TC: 3mm Endmill)
(Begin operation: Profile)
G0 Z5.000
G0 X10.000 Y-5.000
G0 Z3.000
G1 X10.000 Y-5.000 Z-1.500 F200.000
G1 X10.000 Y15.000 Z-1.500 F600.000
G3 X5.000 Y20.000 Z-1.500 I-5.000 J0.000 K0.000 F600.000
G1 X-12.500 Y20.000 Z-1.500 F600.000
G0 Z5.000
G0 X40.000 Y0.000
G1 X40.000 Y0.000 Z0.000 F200.000
G2 X40.000 Y0.000 Z0.000 I-4.000 J0.000 K0.000 F600.000
G0 Z5.000
(Finish operation: Profile)
(Begin postamble)
M5
G17 G90
M2
