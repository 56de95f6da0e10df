%
(A stepped shaft of 30 mm stock, 60 mm long: rough in three cuts, face, finish with rounded corners)
(X is the distance from the turning centre, not the diameter; zero is the middle of the finished face.)
(Run it with --machine lathe2)
N10 G18 G21 G90

(Roughing, 0.4 mm left in X and 0.2 mm in Z)
N20 T1 M6 (T1 CNMG120408 roughing)
N30 G96 S180 M4 M8
N40 G0 X16 Z2
N50 G95 G0 X13
N60 G1 Z-59.8 F0.25
N70 X15.5
N80 G0 Z2
N90 X11.2
N100 G1 Z-33.8
N110 X13.5
N120 G0 Z2
N130 X9.4
N140 G1 Z-32.8
N150 X12
N160 G0 Z2

(Facing)
N170 G0 X16 Z0
N180 G1 X-0.4 F0.12
N190 G0 Z2
N200 X20 Z20

(Finishing: chamfer, step with a fillet, rounded shoulder)
N210 T2 M6 (T2 VNMG160404 finishing)
N220 G96 S240 M4
N230 G0 X6 Z2
N240 G1 Z1 F0.1
N250 X9 Z-2
N260 Z-32
N270 G2 X11 Z-34 I2
N280 G1 X11.6
N290 G3 X12.6 Z-35 K-1
N300 G1 Z-60
N310 X16
N320 G0 X60 Z80 M5 M9
N330 M30
%
