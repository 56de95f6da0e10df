%
(A bracket of 90 x 60 x 10 mm, milled from plate: outline, round pocket, two slots, four holes)
(Zero is the lower left corner of the part, on top. The paths are those of the cutter's centre.)
N10 G17 G21 G90 G94

(Outline, end mill 10 mm, two depths, driven on and off along a quarter circle)
N20 T1 M6
N30 S8000 M3 M8
N40 G0 X-15 Y-15
N50 Z2
N60 G1 Z-5 F300
N70 M98 P100
N80 G1 Z-10 F300
N90 M98 P100
N100 G0 Z25

(Round pocket of 32 mm: down on a helix, then two rings)
N110 G0 X45 Y30
N120 Z1
N130 G1 X50 F1200
N140 G2 X50 Y30 Z-6 I-5 J0 P4 F600
N150 G2 I-5 F900
N160 G1 X56
N170 G2 I-11
N180 G1 X45
N190 G0 Z25

(Two slots across, end mill 6 mm, cut going back and forth)
N200 T2 M6
N210 S12000 M3
N220 G0 X13 Y20
N230 Z1
N240 G1 Z-3 F200
N250 Y40 F700
N260 Z-6 F200
N270 Y20 F700
N280 G0 Z5
N290 X77
N300 G1 Z-3 F200
N310 Y40 F700
N320 Z-6 F200
N330 Y20 F700
N340 G0 Z25

(Four holes of 6.6 mm through the corners, pecking)
N350 T3 M6
N360 S3200 M3
N370 G99 G83 X10 Y10 Z-13 R2 Q4 F250
N380 X80
N390 Y50
N400 X10
N410 G80 M9
N420 G0 Z100 M5
N430 X0 Y0
N440 M30

(Once round the outline, from and to X-15 Y-15)
O100
G1 X-10 Y-15 F2400
G3 X-5 Y-10 I0 J5 F900
G1 Y54
G2 X6 Y65 I11 J0
G1 X84
G2 X95 Y54 I0 J-11
G1 Y6
G2 X84 Y-5 I-11 J0
G1 X6
G2 X-5 Y6 I0 J11
G1 Y10
G3 X-15 Y20 I-10 J0
G0 Z2
X-15 Y-15
M99
%
