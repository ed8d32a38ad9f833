; Two changes of the working mode, where benchtop reaches all of them: --origin 40mm,255.8mm
G0 X0 Y0
M780 I-1 J-1
G1 X0.3 F600
M780 I-1 J1
