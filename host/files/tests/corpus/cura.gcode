;FLAVOR:Marlin
;TIME:66
;Filament used: 0.01m
;MINX:50
;Generated with Cura_SteamEngine 5.6.0
M140 S60
M105
M190 S60
M104 S200
M109 S200
M82 ;absolute extrusion mode
G28 ;Home
G92 E0 ;Reset Extruder
G1 Z2.0 F3000 ;Move Z Axis up
G1 X10.1 Y20 Z0.28 F5000.0 ;Move to start position
G1 X10.1 Y80.0 Z0.28 F1500.0 E15 ;Draw the first line
G1 X10.4 Y80.0 Z0.28 F5000.0 ;Move to side a little
G1 X10.4 Y20 Z0.28 F1500.0 E30 ;Draw the second line
G92 E0 ;Reset Extruder
G1 Z2.0 F3000 ;Move Z Axis up
G92 E0
G1 F2700 E-5
;LAYER_COUNT:1
;LAYER:0
M107
G0 F3600 X50 Y50 Z0.2
;TYPE:WALL-OUTER
G1 F2700 E0
G1 F1200 X70 Y50 E1.5
G1 X70 Y65 E2.5
G1 X50 Y50 E4
G1 F2700 E-1
;TIME_ELAPSED:20.0
G91 ;Relative positioning
G1 E-2 F2700 ;Retract a bit
G1 E-2 Z0.2 F2400 ;Retract and raise Z
G1 X5 Y5 F3000 ;Wipe out
G1 Z10 ;Raise Z more
G90 ;Absolute positioning
G1 X0 Y235 ;Present print
M106 S0 ;Turn-off fan
M104 S0 ;Turn-off hotend
M84 X Y E ;Disable all steppers but Z
M82 ;absolute extrusion mode
;End of Gcode
