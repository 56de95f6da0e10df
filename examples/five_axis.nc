%
(A cone on a tilting table: six pockets with the table indexed, then a spiral groove with all axes at once)
(Positions are those of the axes: the centre of A and C is machine zero, and no transformation is active.)
(Run it with --machine mill5)
N10 G17 G21 G90 G94

(Six pockets: tilt once, then turn the table by 60 degrees for each)
N20 T1 M6 (T1 D=8 flat end mill)
N30 S12000 M3
N40 G0 X0 Y0 Z80 A0 C0
N50 G0 A-35
N60 M98 P200 L6
N70 G0 Z80
N80 C0

(The groove: four turns of the table while the tool climbs down the cone and the table tilts upright)
N90 T2 M6 (T2 D=6 ball end mill)
N100 S16000 M3
N110 G0 X8 Y0
N120 Z32
N130 G1 Z28 F400
N140 G91 X28 Z-22 A25 C1440 F300
N150 G90 G0 Z80
N160 X0 A0
N170 M30

O200
G0 X-6 Y30
Z34
G1 Z30 F300
G91
G1 X12 F900
G3 Y6 J3
G1 X-12
G3 Y-6 J-3
G90
G0 Z45
G91 C60
G90
M99
%
