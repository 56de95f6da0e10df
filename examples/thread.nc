%
(A thread M20 x 1.5, 12 mm deep, cut from below by a thread mill of 10 mm: helices instead of a tap)
N10 G17 G21 G90 G94
N20 T5 M6
N30 S4000 M3 M8
N40 G0 X0 Y0 Z10
N50 Z-12.5
N60 G91
(In on a quarter helix, so that the tool does not leave a mark)
N70 G1 X2.5 Y-2.5 F1200
N80 G3 X2.5 Y2.5 Z0.375 J2.5 F300
(Eight turns of one pitch each, then out)
N90 G3 X0 Y0 Z12 I-5 P8 F500
N100 G3 X-2.5 Y2.5 Z0.375 I-2.5
N110 G1 X-2.5 Y-2.5 F1200
N120 G90
N130 G0 Z100 M5
N140 M30
%
