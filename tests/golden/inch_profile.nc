(A profile in inch, with both radius forms and a full circle)
G20 G90
G0 X1. Y1.
F10.
G1 Z-.1
X2.
G3 X2.5 Y1.5 R.5
G1 Y2.
G3 X2. Y2.5 I-.5
G2 X1.5 Y2. R-.5
G0 Z.5
X0 Y0
G1 Z0
G2 I.25
G1 A30. F90
X1. A0 F10.
G21 X0
M2
