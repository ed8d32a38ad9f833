; The demonstration: a rosette of six circles in a ring, and the project's name below.
; 100 mm wide, 84 mm high; (0, 0) is 18 mm below the rosette's centre.
G21 ; millimetres
G90 ; absolute
M5 ; pen up
F15000 ; 0.25 m/s

; Six circles through the middle
G0 X0 Y18
M3
G4 S0.04
G2 I0 J16
G2 I13.856 J8
G2 I13.856 J-8
G2 I0 J-16
G2 I-13.856 J-8
G2 I-13.856 J8
M5

; The ring around them
G0 X0 Y50
M3
G4 S0.04
G2 J-32
M5

; FIVEBAR
; F
G0 X-50 Y-34
M3
G4 S0.04
G1 X-50 Y-18
G1 X-40 Y-18
M5
G0 X-42 Y-25
M3
G4 S0.04
G1 X-50 Y-25
M5
; I
G0 X-33 Y-34
M3
G4 S0.04
G1 X-33 Y-18
M5
; V
G0 X-27 Y-18
M3
G4 S0.04
G1 X-21 Y-34
G1 X-15 Y-18
M5
; E
G0 X1 Y-18
M3
G4 S0.04
G1 X-9 Y-18
G1 X-9 Y-34
G1 X1 Y-34
M5
G0 X-1 Y-25.5
M3
G4 S0.04
G1 X-9 Y-25.5
M5
; B
G0 X7 Y-34
M3
G4 S0.04
G1 X7 Y-18
G1 X13 Y-18
G2 X13 Y-25.5 I0 J-3.75
G1 X7 Y-25.5
M5
G0 X13 Y-25.5
M3
G4 S0.04
G2 X13 Y-34 I0 J-4.25
G1 X7 Y-34
M5
; A
G0 X22 Y-34
M3
G4 S0.04
G1 X28 Y-18
G1 X34 Y-34
M5
G0 X31.75 Y-28
M3
G4 S0.04
G1 X24.25 Y-28
M5
; R
G0 X39 Y-34
M3
G4 S0.04
G1 X39 Y-18
G1 X45 Y-18
G2 X45 Y-26 I0 J-4
G1 X39 Y-26
M5
G0 X44.5 Y-26
M3
G4 S0.04
G1 X50 Y-34
M5

G28 ; home
M2
